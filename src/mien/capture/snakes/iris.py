"""Where the irises are: the dark discs beside the whites of the eyes, sought for both at once.

Eyes mostly look the same way, so of two places that fit alike the pair that agrees is taken. They
may cross: disagreement costs only so much.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.capture.snakes.colour.transform import Field
from mien.capture.snakes.curves.fields import Look
from mien.capture.snakes.head.patch import COARSE, ORIGIN

Array = NDArray[np.float64]

RADIUS = 9.3
"""Patch units of an iris (11.7 mm across; pupils 63 mm apart)."""
_SIDE, _TALL, _SHARE = 1.75, 0.6, 0.5
"""How far the whites reach and how tall they are, in radii, and what they count."""
_APART, _ASIDE = 0.001, 0.0004
"""Per squared patch unit: what it costs to disagree, and to look aside."""
_CROSSED = 144.0
"""Squared patch units of disagreement beyond which it costs no more."""
_REACH, _FALL = 14, 5
"""Patch units across, and pixels of the small patch up or down, in which they are sought."""
_DARKEST = 1.2


def _disc() -> Field:
    """The pattern on the small patch: 1 in all in the disc, less where whites are."""
    radius = RADIUS / COARSE
    reach = int(np.ceil(_SIDE * radius)) + 1
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1].astype(float)
    away = np.hypot(x, y)
    disc = np.clip(radius + 0.5 - away, 0.0, 1.0)
    whites = np.clip(_SIDE * radius + 0.5 - away, 0.0, 1.0)
    whites *= (away > radius + 1.0) & (np.abs(y) < _TALL * radius)
    pattern = disc / disc.sum() - _SHARE * whites / whites.sum()
    return np.asarray(pattern, dtype=np.float32)


_PATTERN = _disc()
_MARGIN = len(_PATTERN) // 2
_ACROSS = np.arange(-_REACH, _REACH + 1, dtype=float)
_DOWN = np.arange(-_FALL - 1, _FALL, dtype=float) * COARSE / 2.0
_AGREE = _APART * np.minimum((_ACROSS[:, None] - _ACROSS) ** 2, _CROSSED) + _ASIDE * (
    _ACROSS[:, None] ** 2 + _ACROSS**2
)
_WIDE, _HIGH = 2 * _REACH // COARSE + 2, 2 * _FALL // COARSE + 2
"""Pixels between which all those places lie."""


def find_irises(look: Look, eyes: Array) -> Array:
    """(2, 2) patch units of both irises between the corners of ``eyes`` (2, 6, 2)."""
    middles = 0.5 * (eyes[:, 0] + eyes[:, 1])
    fits = [fit_iris(look.value, look.mean, middle) for middle in middles]
    best = fits[0].max(axis=0)[:, None] + fits[1].max(axis=0) - _AGREE
    for middle, fit, column in zip(middles, fits, divmod(best.argmax(), len(_ACROSS)), strict=True):
        middle += _ACROSS[column], _DOWN[fit[:, column].argmax()]
    return np.asarray(middles)


@njit(cache=True, nogil=True, fastmath=True)
def fit_iris(value: Field, mean: Field, middle: Array) -> Array:
    """(down, across) how well an iris fits at each place round the ``middle`` (2,) of an eye,
    patch units, on brightness ``value`` and its neighbourhood's ``mean``. Between pixels it is
    what fits at those next to the place."""
    rows, columns = value.shape
    x = (middle[0] + _ACROSS[0] + ORIGIN[0] - 0.5 * (COARSE - 1)) / COARSE
    y = (middle[1] + _DOWN[0] + ORIGIN[1] - 0.5 * (COARSE - 1)) / COARSE
    left, top = int(np.floor(x)), int(np.floor(y))
    dark = np.empty((_HIGH + 2 * _MARGIN, _WIDE + 2 * _MARGIN), np.float32)
    for j in range(dark.shape[0]):
        row = min(max(top - _MARGIN + j, 0), rows - 1)
        for i in range(dark.shape[1]):
            column = min(max(left - _MARGIN + i, 0), columns - 1)
            around = max(mean[row, column], np.float32(1.0))
            ratio = around / max(value[row, column], np.float32(1.0))
            dark[j, i] = min(np.log(max(ratio, np.float32(1.0))), np.float32(_DARKEST))
    whole = np.zeros((_HIGH, _WIDE), np.float32)
    for j in range(_HIGH):
        for v in range(len(_PATTERN)):
            for u in range(len(_PATTERN)):
                if _PATTERN[v, u] != 0.0:
                    for i in range(_WIDE):
                        whole[j, i] += _PATTERN[v, u] * dark[j + v, i + u]
    fit = np.empty((len(_DOWN), len(_ACROSS)))
    for j in range(len(_DOWN)):
        for i in range(len(_ACROSS)):
            across, down = x - left + i / COARSE, y - top + j / COARSE
            column, row = int(across), int(down)
            fx, fy = across - column, down - row
            upper = whole[row, column] * (1.0 - fx) + whole[row, column + 1] * fx
            lower = whole[row + 1, column] * (1.0 - fx) + whole[row + 1, column + 1] * fx
            fit[j, i] = upper * (1.0 - fy) + lower * fy
    return fit
