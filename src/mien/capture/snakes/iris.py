"""Where the irises are: the dark discs beside the whites of the eyes, sought for both at once.

Eyes mostly look the same way, so of two places that fit alike the pair that agrees is taken. They
may cross: that costs only so much. They do not part.
"""

from __future__ import annotations

from dataclasses import dataclass

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
_CROSSING, _PARTING, _ASIDE = 0.001, 0.005, 0.0004
"""Per squared patch unit: what it costs to cross, to part, and to look aside."""
_CROSSED = 144.0
"""Squared patch units beyond which it costs no more to cross."""
_REACH, _FALL = 14, 5
"""Patch units across, and pixels of the small patch up or down, in which they are sought."""
_DARKEST = 1.2
_LEARNT, _SURPRISE = 0.1, 4.0
"""Share by which a frame changes how far irises mostly are apart, and of how many patch units at
most: now and then eyes cross."""
_HIDDEN, _PLAIN = 0.35, 0.5
"""How well the best place fits, over what a disc of all that is darkest round it would: for lashes
of a lid that is down, which are a line, and for an iris."""


@dataclass(frozen=True, slots=True)
class Irises:
    """Those of the right and the left eye."""

    places: Array
    """(2, 2) patch units."""
    aside: Array
    """(2, 2) from the middles of the eyes, patch units."""
    plain: Array
    """(2,) how plainly they are seen, 0..1: not behind a lid that is down."""
    apart: float | None
    """Patch units by which they mostly are farther apart than the middles of the eyes: faces
    differ, and so do the corners that curves find. None as long as they were not plainly seen."""


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
_APART = _ACROSS - _ACROSS[:, None]
_LOOKS_ASIDE = _ASIDE * (_ACROSS[:, None] ** 2 + _ACROSS**2)
_WIDE, _HIGH = 2 * _REACH // COARSE + 2, 2 * _FALL // COARSE + 2
"""Pixels between which all those places lie."""
_ROUND = (np.array([_REACH, _FALL]) + 1.5 * RADIUS) / COARSE
_DISC = round(np.pi * (RADIUS / COARSE) ** 2)
"""Pixels to each side of an eye's middle in which it is dark, and those of an iris."""


def find_irises(look: Look, middles: Array, apart: float | None = None) -> Irises:
    """Both irises round the ``middles`` (2, 2) of the right and the left eye, patch units;
    ``apart`` as the last frame told."""
    fits = [fit_iris(look.value, look.mean, middle) for middle in middles]
    best = [fit.max(axis=0) for fit in fits]
    worth = best[0][:, None] + best[1] - _LOOKS_ASIDE - _disagreement(apart)
    chosen = divmod(int(worth.argmax()), len(_ACROSS))
    aside, plain = np.empty((2, 2)), np.empty(2)
    for eye, column in enumerate(chosen):
        aside[eye] = _ACROSS[column], _DOWN[fits[eye][:, column].argmax()]
        share = best[eye][column] / _darkest(look, middles[eye])
        plain[eye] = (share - _HIDDEN) / (_PLAIN - _HIDDEN)
    plain = plain.clip(0.0, 1.0)
    return Irises(middles + aside, aside, plain, _learnt(apart, aside[1, 0] - aside[0, 0], plain))


def _disagreement(apart: float | None) -> Array:
    """What it costs a pair of places to cross or to part."""
    parted = _APART - (apart or 0.0)
    cost = _CROSSING * np.minimum(parted**2, _CROSSED)
    return cost if apart is None else np.where(parted > 0.0, _PARTING * parted**2, cost)


def _learnt(apart: float | None, now: float, plain: Array) -> float | None:
    """``apart`` after a frame in which it is ``now`` so much."""
    if apart is None:
        return now if plain.min() > 0.5 else None
    return apart + _LEARNT * float(plain.min()) * min(max(now - apart, -_SURPRISE), _SURPRISE)


def _darkest(look: Look, middle: Array) -> float:
    """How dark an iris would be that were all that is darkest round the ``middle`` of an eye."""
    x, y = (middle + ORIGIN) / COARSE
    left, top = np.maximum([x - _ROUND[0], y - _ROUND[1]], 0.0).astype(int).tolist()
    rows, columns = slice(top, int(y + _ROUND[1]) + 1), slice(left, int(x + _ROUND[0]) + 1)
    shown = np.maximum(look.value[rows, columns], 1.0)
    dark = np.log(np.maximum(look.mean[rows, columns], 1.0) / shown).clip(0.0, _DARKEST)
    if dark.size <= _DISC:
        return _DARKEST
    return max(float(np.partition(dark, -_DISC, axis=None)[-_DISC:].mean()), 1e-3)


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
