"""One frame: every feature is lit up in its rectangle, and its curves come to rest there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.aperture import aperture
from mien.capture.snakes.colour.glow import dimmed, excess
from mien.capture.snakes.colour.pigments import pigments
from mien.capture.snakes.colour.transform import Field, window
from mien.capture.snakes.curves.features import FEATURES, MOUTH, ROW
from mien.capture.snakes.curves.fields import (
    Look,
    Weigh,
    brow_field,
    corner_of,
    field_of,
    look_at,
)
from mien.capture.snakes.curves.settle import Expected, Settled, settle
from mien.capture.snakes.doubt import doubtful
from mien.capture.snakes.gape import find_gape
from mien.capture.snakes.head.patch import COARSE, Picture, grey_of
from mien.capture.snakes.iris import find_irises
from mien.capture.snakes.mouth import (
    LipColour,
    Opening,
    around,
    find_opening,
    lip_colour,
    look_inside,
)
from mien.capture.snakes.seen import Seen, Start
from mien.capture.snakes.tongue import Tongue, find_tongue

Array = NDArray[np.float64]

_EYES = np.array([ROW["eye_right"], ROW["eye_left"]])
_LIPS = ROW["lips"]


@dataclass(frozen=True, slots=True)
class Known:
    """What is known of a face before a frame is looked at."""

    rest: Array
    """(L, 6, 3) features at rest, patch units with depth."""
    learnt: bool
    """They are this performer's own."""
    last: Seen | None
    weigh: Weigh
    gains: Array | None
    """(3,) of the light, where each frame's own skin does not tell."""


def fit(image: Picture, start: Start, known: Known, strange: bool = False) -> Seen:
    """All curves of a face in ``image`` from ``start`` on; ``strange`` where it is not sure whether
    the patch lies right."""
    patch, last = start.placement.warp(image), known.last
    look = look_at(patch, known.gains)
    weights = known.weigh(look, start.lenses)
    curves = _Curves(start, known, strange)
    apertures = []
    for row, feature in enumerate(FEATURES[:_LIPS]):
        lit = field_of(look, feature, weights)
        if feature.group == "eye":
            apertures.append(aperture(lit))
        if feature.group == "brow":
            eye = curves.lenses[ROW[feature.name.replace("brow", "eye")]]
            lit = brow_field(lit, corner_of(feature), curves.rest[row], eye)
        curves.settle(row, lit)
    lit = field_of(look, FEATURES[_LIPS], weights)
    glow = excess(lit, None if last is None else last.glow)
    colour = _fit_lips(curves, look, dimmed(lit, glow), None if last is None else last.lips)
    mouth = _look_into(curves, look, colour, None if last is None else last.tongue)
    curves.lenses[MOUTH] = mouth.opening.lens
    middles = (curves.rest if curves.known else curves.lenses)[_EYES, :2].mean(axis=1)
    return Seen(
        start.placement,
        start.pose,
        curves.lenses,
        start.rigid,
        curves.lost,
        curves.contrast,
        mouth.opening,
        mouth.tongue,
        find_irises(look, middles, None if last is None else last.irises.apart),
        np.array(apertures),
        look,
        weights,
        grey_of(patch),
        mouth.lips,
        glow,
    )


class _Curves:
    """The curves of one frame, which come to rest one after another."""

    def __init__(self, start: Start, known: Known, strange: bool) -> None:
        self.known, self.strange = known.learnt and not strange, strange
        self.rest, self.lenses = start.pose(known.rest), start.lenses.copy()
        self.lost, self.contrast = np.zeros(MOUTH, dtype=bool), np.zeros(MOUTH)
        self._gone = np.zeros(MOUTH, dtype=bool) if known.last is None else known.last.lost

    def settle(self, row: int, lit: Field, hint: Array | None = None) -> Settled:
        """Let the curves of one feature come to rest in its field; those that are lost stay where
        they were."""
        feature, gone = FEATURES[row], bool(self._gone[row])
        expected = Expected(self.rest[row], self.lenses[row], self.known, gone, hint)
        settled = settle(feature.group, lit, corner_of(feature), expected, feature.pitch)
        self.lost[row], self.contrast[row] = settled.lost, settled.contrast
        if not settled.lost or self.strange:
            self.lenses[row] = settled.lens
        return settled


@dataclass(frozen=True, slots=True)
class _Mouth:
    """What was found inside the lips."""

    opening: Opening
    tongue: Tongue | None
    lips: LipColour


def _fit_lips(curves: _Curves, look: Look, lit: Field, lips: LipColour | None) -> LipColour:
    """Let the lips come to rest in their field, with the open mouth lit up, and say what colour
    they were taken to have: ``lips`` where it is known."""
    seen = pigments(look.small, look.gains, window(FEATURES[_LIPS].box, COARSE), COARSE)
    lips = lips or lip_colour(curves.lenses[_LIPS], seen)
    gape = find_gape(lit, seen, lips)
    settled = curves.settle(_LIPS, gape.field, gape.lens)
    curves.lost[_LIPS] |= doubtful(settled.lens, settled.contrast, lit, seen)
    return lips


def _look_into(curves: _Curves, look: Look, lips: LipColour, tongue: Tongue | None) -> _Mouth:
    """What shows between the lips where they are, ``lips`` and ``tongue`` being as last seen."""
    if curves.lost[_LIPS] and not curves.strange:
        return _Mouth(Opening(curves.lenses[MOUTH], 0.0), tongue and tongue.hidden(), lips)
    outline = curves.lenses[_LIPS]
    seen = pigments(look.patch, look.gains, around(outline), 1)
    lips = lip_colour(outline, seen)
    inside = look_inside(outline, seen, lips)
    opening = find_opening(outline, seen, inside)
    return _Mouth(opening, find_tongue(outline, opening.lens, seen, inside, tongue), lips)
