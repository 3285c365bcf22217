"""One feature in one frame: where its curves come to rest, from coarse to fine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.colour.transform import Field
from mien.capture.snakes.curves.blobs import blob_lens, find_blob
from mien.capture.snakes.curves.energy import Terms, descend, energy, packed
from mien.capture.snakes.curves.lens import tallness
from mien.capture.snakes.curves.priors import prior

Array = NDArray[np.float64]

_BLURS = (3.0, 1.5, 0.8)
"""Patch units, coarse to fine."""
_STEPS = (10, 10, 12)
_FIRST_STEP = (2.0, 1.0, 1.0)
_REACH, _LEAST_REACH, _MOST_REACH = 0.2, 1.2, 6.0
"""Distance of the offset curves, in heights of the lens, and its bounds."""
_THICKEST_BROW = 24.0
"""A taller blob is hair."""
_NARROWEST = {"brow": 0.0, "eye": 0.0, "lip": 38.0}
_TALLER, _FLATTER = 1.25, 0.8
_NOTHING = np.zeros((12, 12)), np.zeros(12)

LEAST_CONTRAST = {"brow": 0.08, "eye": 0.12, "lip": 0.12}
"""Mean difference of I across the curves below which a feature counts as lost."""
_FARTHEST = {"brow": 26.0, "eye": 14.0, "lip": 45.0}
"""Patch units from its place at rest beyond which no feature goes."""
_TALLEST = {"brow": 32.0, "eye": 36.0, "lip": 105.0}
_WIDEST = {"brow": 100.0, "eye": 66.0, "lip": 115.0}
_MOST_LEAN = np.cos(np.radians(35.0))
"""Of the line between the ends from that at rest. Mouths of grimaces lean up to 32 degrees, shadows
between the fingers of a hand 50: they have the darkness and the edges of a mouth, but not this."""


@dataclass(frozen=True, slots=True)
class Settled:
    """Where a feature's curves came to rest."""

    lens: Array
    """(6, 2)"""
    energy: float
    contrast: float
    """Mean I just inside the curves minus just outside, -1..1."""
    lost: bool
    """The curves lie on nothing, or where no feature can be."""


@dataclass(frozen=True, slots=True)
class Expected:
    """What is known of a feature before it is looked at."""

    rest: Array
    """(6, 2) at rest, with the head turned as it is."""
    last: Array
    """(6, 2) in the frame before."""
    known: bool
    """``rest`` is the performer's own."""
    lost: bool
    """It was lost in the frame before."""


def settle(group: str, field: Field, corner: Array, expected: Expected) -> Settled:
    """The lens of a feature of ``group`` on its rectangle's ``field``, whose first pixel is at
    ``corner``. Lips are sought from several starts, for they move fast; others from the last
    frame, and from their blob where that leads to nothing."""
    quadratic, linear = prior(group, expected.rest, expected.last, expected.known)
    width = _NARROWEST[group]
    blurred = [
        np.asarray(cv2.GaussianBlur(field, (0, 0), blur), dtype=np.float32) for blur in _BLURS
    ]

    def slide(lens: Array, level: int) -> tuple[Array, float]:
        place, value = descend(
            lens.reshape(12),
            blurred[level],
            corner,
            packed(Terms(reach=_reach(lens), least_width=width)),
            quadratic,
            linear,
            _STEPS[level],
            _FIRST_STEP[level],
        )
        return place.reshape(6, 2), value

    starts = _starts(group, field, corner, expected)
    lens, value = min((slide(start, 0) for start in starts), key=lambda slid: slid[1])
    for level in range(1, len(_BLURS)):
        lens, value = slide(lens, level)
    across, _ = energy(lens, blurred[1], corner, Terms(0.0, 1.0, 1.0, _reach(lens)), *_NOTHING)
    lost = -across < LEAST_CONTRAST[group] or _wild(group, lens, expected.rest)
    return Settled(lens, value, -across, lost)


def _reach(lens: Array) -> float:
    return min(max(_REACH * tallness(lens), _LEAST_REACH), _MOST_REACH)


def _starts(group: str, field: Field, corner: Array, expected: Expected) -> Sequence[Array]:
    last = expected.last
    starts = [last]
    blob = None
    # Blobs cost a third of the time, and lead brows and eyes nowhere they would not go.
    if group == "lip" or expected.lost or not expected.known:
        blob = find_blob(field, last.mean(axis=0) - corner)
    if blob is not None:
        lens = blob_lens(blob, corner)
        if group != "brow" or tallness(lens) <= _THICKEST_BROW:
            starts.append(lens)
    if group == "lip":
        middle = last.mean(axis=0)
        starts += [middle + (last - middle) * np.array([1.0, s]) for s in (_FLATTER, _TALLER)]
    if group == "lip" or expected.lost:
        starts.append(expected.rest)
    return starts


def _wild(group: str, lens: Array, rest: Array) -> bool:
    away = float(np.linalg.norm(lens.mean(axis=0) - rest.mean(axis=0)))
    chord, resting = lens[1] - lens[0], rest[1] - rest[0]
    wide = float(np.linalg.norm(chord))
    along = float(chord @ resting) / max(wide * float(np.linalg.norm(resting)), 1e-9)
    return bool(
        away > _FARTHEST[group]
        or tallness(lens) > _TALLEST[group]
        or wide > _WIDEST[group]
        or along < _MOST_LEAN
    )
