"""One feature in one frame: where its curves come to rest, from coarse to fine."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.capture.snakes.colour.transform import Field
from mien.capture.snakes.curves.blobs import blob_lens, find_blob
from mien.capture.snakes.curves.energy import Terms, descend, evaluate, packed
from mien.capture.snakes.curves.lens import tallness
from mien.capture.snakes.curves.priors import prior

Array = NDArray[np.float64]

_BLURS = (3.0, 1.5, 0.8)
"""Patch units, coarse to fine."""
_STEPS = (8, 6, 8)
_FIRST_STEP = (2.0, 1.0, 1.0)
_REACH, _LEAST_REACH, _MOST_REACH = 0.2, 1.2, 6.0
"""Distance of the offset curves, in heights of the lens, and its bounds."""
_NEGLIGIBLE = 0.3
"""Pixels of a blur that changes nothing."""
_THICKEST_BROW = 24.0
"""A taller blob is hair."""
_NARROWEST = {"brow": 0.0, "eye": 0.0, "nostril": 0.0, "lip": 38.0}
_TALLER, _FLATTER = 1.25, 0.8
LEAST_CONTRAST = {"brow": 0.08, "eye": 0.12, "nostril": 0.15, "lip": 0.12}
"""Mean difference of I across the curves below which a feature counts as lost."""
_FARTHEST = {"brow": 26.0, "eye": 14.0, "nostril": 14.0, "lip": 45.0}
"""Patch units from its place at rest beyond which no feature goes."""
_TALLEST = {"brow": 32.0, "eye": 36.0, "nostril": 16.0, "lip": 105.0}
_WIDEST = {"brow": 100.0, "eye": 66.0, "nostril": 30.0, "lip": 115.0}
_COVERED = {"brow": 0.0, "eye": 0.0, "nostril": 6.0, "lip": 48.0}
"""A narrower one is partly hidden: mouths that whistle keep 50 units of width in six films, those
half behind a hand have 38 to 48."""
_MOST_LEAN = np.cos(np.radians(35.0))
"""Of the line between the ends from that at rest. Mouths of grimaces lean up to 32 degrees, shadows
between the fingers of a hand 50: they have the darkness and the edges of a mouth, but not this."""
_LIMITS = {
    group: np.array(
        [
            LEAST_CONTRAST[group],
            _FARTHEST[group],
            _TALLEST[group],
            _WIDEST[group],
            _COVERED[group],
        ]
    )
    for group in LEAST_CONTRAST
}


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
    hint: Array | None = None
    """(6, 2) where else the picture has it."""


def settle(
    group: str, field: Field, corner: Array, expected: Expected, pitch: float = 1.0
) -> Settled:
    """The lens of a feature of ``group`` on its rectangle's ``field``, whose first pixel is at
    ``corner`` and whose pixels are ``pitch`` patch units apart. Lips are sought from several
    starts, for they move fast; others from the last frame, and from their blob where that leads
    to nothing."""
    starts = np.concatenate(_starts(group, field, corner, expected, pitch)).reshape(-1, 12)
    coarse, middle, fine = (_blurred(field, blur) for blur in _blurs(pitch))
    place, value, across, lost = _come_to_rest(
        starts,
        (coarse, middle, fine),
        corner,
        _terms(group, pitch),
        *prior(group, expected.rest, expected.last, expected.known),
        expected.rest,
        _LIMITS[group],
    )
    return Settled(place.reshape(6, 2), value, across, lost)


def _blurred(field: Field, blur: float) -> Field:
    if blur < _NEGLIGIBLE:
        return field
    return np.asarray(cv2.GaussianBlur(field, (0, 0), blur), dtype=np.float32)


@cache
def _terms(group: str, pitch: float) -> Array:
    return packed(Terms(least_width=_NARROWEST[group], pitch=pitch))


@cache
def _blurs(pitch: float) -> tuple[float, ...]:
    """_BLURS in pixels, of which pixels ``pitch`` patch units apart have taken a share."""
    left = np.maximum(np.square(_BLURS) - (pitch**2 - 1.0) / 12.0, 0.0)
    return tuple((np.sqrt(left) / pitch).tolist())


@njit(cache=True, nogil=True)
def _come_to_rest(
    starts: Array,
    fields: tuple[Field, Field, Field],
    corner: Array,
    terms: Array,
    quadratic: Array,
    linear: Array,
    rest: Array,
    limits: Array,
) -> tuple[Array, float, float, bool]:
    """Lens (12,), energy, contrast, and whether it is lost: the best of the starts (S, 12) on the
    coarse field, brought to rest on the finer ones."""
    terms = terms.copy()
    best, least = starts[0], np.inf
    for level in range(len(_STEPS)):
        begin, least = starts if level == 0 else best.reshape(1, 12), np.inf
        for start in range(len(begin)):
            terms[3] = _reach(begin[start])
            place, value = descend(
                begin[start],
                fields[level],
                corner,
                terms,
                quadratic,
                linear,
                _STEPS[level],
                _FIRST_STEP[level],
            )
            if value < least:
                best, least = place, value
    terms[0], terms[3], terms[4] = 0.0, _reach(best), 0.0
    nothing = np.zeros((12, 12))
    across = -evaluate(best, fields[1], corner, terms, nothing, nothing[0], np.empty(12))
    lost = across < limits[0] or _wild(best.reshape(6, 2), rest, limits)
    return best, least, across, lost


@njit(cache=True, nogil=True)
def _reach(lens: Array) -> float:
    return min(max(_REACH * tallness(lens.reshape(6, 2)), _LEAST_REACH), _MOST_REACH)


@njit(cache=True, nogil=True)
def _wild(lens: Array, rest: Array, limits: Array) -> bool:
    """Whether a lens (6, 2) is where, or as, no feature can be."""
    away_x, away_y = 0.0, 0.0
    for point in range(6):
        away_x += (lens[point, 0] - rest[point, 0]) / 6.0
        away_y += (lens[point, 1] - rest[point, 1]) / 6.0
    x, y = lens[1, 0] - lens[0, 0], lens[1, 1] - lens[0, 1]
    u, v = rest[1, 0] - rest[0, 0], rest[1, 1] - rest[0, 1]
    wide = np.hypot(x, y)
    along = (x * u + y * v) / max(wide * np.hypot(u, v), 1e-9)
    return bool(
        np.hypot(away_x, away_y) > limits[1]
        or tallness(lens) > limits[2]
        or wide > limits[3]
        or wide < limits[4]
        or along < _MOST_LEAN
    )


def _starts(
    group: str, field: Field, corner: Array, expected: Expected, pitch: float
) -> list[Array]:
    last = expected.last
    starts = [last]
    blob = None
    # Blobs cost a third of the time, and lead brows and eyes nowhere they would not go.
    if group == "lip" or not expected.known or (expected.lost and group != "nostril"):
        blob = find_blob(field, (last.mean(axis=0) - corner) / pitch, pitch)
    if blob is not None:
        lens = blob_lens(blob, corner, pitch)
        if group != "brow" or tallness(lens) <= _THICKEST_BROW:
            starts.append(lens)
    if group == "lip":
        middle = last.mean(axis=0)
        starts += [middle + (last - middle) * np.array([1.0, s]) for s in (_FLATTER, _TALLER)]
    if group == "lip" or expected.lost:
        starts.append(expected.rest)
    if expected.hint is not None:
        starts.append(expected.hint)
    return starts
