"""The neutral of a marker take: a stretch in which the face rests."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.errors import InputError

Array = NDArray[np.float64]

STRETCH = 0.3
"""Seconds: a single frame is noisy, and faces do not rest long."""
_UNREST = 3.0
"""What stillness counts for against nearness to what the face mostly is, both in mm."""
_LATE = 2.0
"""mm that the end of the take counts for more than its beginning: takes begin at rest."""


def find_rest(places: Array, rate: float) -> slice:
    """The frames of the most neutral stretch of ``places`` (F, M, 3), the head's motion undone:
    where the face is stillest and near what it mostly is, rather early than late."""
    length = min(max(round(STRETCH * rate), 1), len(places))
    away = places - np.median(places, axis=0)
    mean = _running_mean(away, length)
    square = _running_mean((away**2).sum(axis=-1), length)
    scatter = np.clip(square - (mean**2).sum(axis=-1), 0.0, None).mean(axis=1)
    # What is left of the stillest stretch is the cameras' noise, not the face's.
    unrest = np.sqrt(np.clip(scatter - scatter.min(), 0.0, None))
    apart = np.sqrt((mean**2).sum(axis=-1).mean(axis=1))
    late = np.linspace(0.0, _LATE, len(apart))
    first = int(np.argmin(apart + _UNREST * unrest + late))
    return slice(first, first + length)


def named_rest(time: Array, span: tuple[float, float]) -> slice:
    """The frames between two ``time``s (F,) in seconds. Raises InputError where there are none."""
    inside = np.flatnonzero((time >= span[0] - 1e-6) & (time <= span[1] + 1e-6))
    if not len(inside):
        raise InputError(f"--neutral: the take has {time[-1]:g} s, and none at {span[0]:g} s")
    return slice(int(inside[0]), int(inside[-1]) + 1)


def _running_mean(values: Array, length: int) -> Array:
    """(F - length + 1, ...) means of every run of ``length`` frames."""
    sums = np.concatenate([np.zeros((1, *values.shape[1:])), np.cumsum(values, axis=0)])
    return np.asarray((sums[length:] - sums[:-length]) / length)
