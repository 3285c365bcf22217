"""Smooth weights in space, the sculptor's fingers."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def ramp(start: float, end: float, value: ArrayLike) -> Array:
    """0 before ``start``, 1 after ``end``, smooth between."""
    t = np.clip((np.asarray(value, dtype=float) - start) / (end - start), 0.0, 1.0)
    return np.asarray(t * t * (3 - 2 * t))


def bump(places: Array, centre: ArrayLike, radii: ArrayLike) -> Array:
    """(N,) Gauss bell round ``centre`` and round its mirror image: 1 there, 1/e at the radii."""
    folded = places * [1, 1, 1]
    folded[:, 0] = np.abs(folded[:, 0])
    return np.asarray(np.exp(-(((folded - np.asarray(centre)) / np.asarray(radii)) ** 2).sum(1)))


def sided(places: Array, push: ArrayLike) -> Array:
    """(N, 3) ``push`` for the left half, its mirror image for the right."""
    sides = np.ones((len(places), 3))
    sides[:, 0] = np.sign(places[:, 0])
    return np.asarray(push, dtype=float) * sides
