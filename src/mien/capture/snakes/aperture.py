"""How tall an eye stands open, seen in one frame alone.

Curves come to rest near where they began: a lid that falls within a frame leaves its curve on the
crease above, where the skin has edges too. How much of the eye's rectangle is eye knows no past.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.capture.snakes.colour.transform import Field

Array = NDArray[np.float64]

_EYE = 0.5
"""I from which a pixel is eye."""
_ASIDE = 14
"""Patch units to each side of the rectangle's middle: beyond are corners, lashes and paint."""
_TALL = 0.75
"""Which column stands for all: the iris's, where white and skin are hard to tell."""
_RANKS = np.arange(2.0 * _ASIDE)
_ROUND = 0.9
"""Mean height of an open eye's curves over the height of that column."""


def aperture(field: Field) -> float:
    """Mean height of the eye in its rectangle's ``field`` (H, W) of one patch unit a pixel, patch
    units: that of curves which miss nothing."""
    middle = field.shape[1] // 2
    heights = tallest_runs(field[:, middle - _ASIDE : middle + _ASIDE])
    return _ROUND * float(np.interp(_TALL * (len(heights) - 1), _RANKS, np.sort(heights)))


@njit(cache=True, nogil=True)
def tallest_runs(field: Field) -> Array:
    """(W,) the most pixels of eye in a row, column by column, of ``field`` (H, W)."""
    rows, columns = field.shape
    longest = np.zeros(columns)
    for x in range(columns):
        run = 0
        for y in range(rows):
            run = run + 1 if field[y, x] > _EYE else 0
            longest[x] = max(longest[x], run)
    return longest
