"""One feature in one frame: several starts, the best one carried from coarse to fine."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.blobs import blob_lens, find_blob
from mien.capture.snakes.colour import Field
from mien.capture.snakes.energy import Terms, descend, packed
from mien.capture.snakes.lens import height
from mien.capture.snakes.priors import prior

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


@dataclass(frozen=True, slots=True)
class Settled:
    """Where a feature's curves came to rest."""

    lens: Array
    """(6, 2)"""
    energy: float


def settle(
    group: str, field: Field, corner: Array, rest: Array, last: Array, known: bool
) -> Settled:
    """The lens of a feature of ``group`` on its rectangle's ``field``, whose first pixel is at
    ``corner``; see ``prior`` for ``rest``, ``last`` and ``known``."""
    quadratic, linear = prior(group, rest, last, known)
    width = _NARROWEST[group]

    def slide(lens: Array, level: int) -> Settled:
        reach = float(np.clip(_REACH * height(lens), _LEAST_REACH, _MOST_REACH))
        numbers = packed(Terms(reach=reach, least_width=width))
        place, value = descend(
            lens.reshape(12),
            blurred[level],
            corner,
            numbers,
            quadratic,
            linear,
            _STEPS[level],
            _FIRST_STEP[level],
        )
        return Settled(place.reshape(6, 2), value)

    blurred = [cv2.GaussianBlur(field, (0, 0), blur) for blur in _BLURS]
    starts = _starts(group, field, corner, rest, last)
    best = min((slide(start, 0) for start in starts), key=lambda settled: settled.energy)
    for level in range(1, len(_BLURS)):
        best = slide(best.lens, level)
    return best


def _starts(group: str, field: Field, corner: Array, rest: Array, last: Array) -> Sequence[Array]:
    starts = [last]
    blob = find_blob(field, last.mean(axis=0) - corner)
    if blob is not None:
        lens = blob_lens(blob, corner)
        if group != "brow" or height(lens) <= _THICKEST_BROW:
            starts.append(lens)
    if group == "lip":
        middle = last.mean(axis=0)
        starts += [middle + (last - middle) * np.array([1.0, s]) for s in (_FLATTER, _TALLER)]
        starts.append(rest)
    return starts
