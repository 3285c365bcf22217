"""Cubic Bezier curves of four control points, sampled at many places at once."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def bernstein(s: Array) -> Array:
    """(S, 4) weights of the control points at parameters ``s`` (S,), 0..1; rows sum to 1."""
    r = 1.0 - s
    return np.stack([r**3, 3.0 * r**2 * s, 3.0 * r * s**2, s**3], axis=1)


def bernstein_slope(s: Array) -> Array:
    """(S, 4) their derivatives by ``s``; rows sum to 0."""
    r = 1.0 - s
    return np.stack([-3.0 * r**2, 3.0 * r * (r - 2.0 * s), 3.0 * s * (2.0 * r - s), 3.0 * s**2], 1)


def curve(control: Array, samples: int) -> Array:
    """(..., S, 2) places evenly spaced in the parameter on curves of ``control`` (..., 4, 2)."""
    return np.asarray(_even(samples) @ control)


@cache
def _even(samples: int) -> Array:
    return bernstein(np.linspace(0.0, 1.0, samples))


def fit(places: Array) -> Array:
    """(4, 2) control points of the curve of least squares through ``places`` (N, 2), parameters
    by chord length. It begins at the first place and ends at the last."""
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1))])
    weights = bernstein(length / length[-1])
    ends = places[[0, -1]]
    rest = places - weights[:, [0, 3]] @ ends
    middle = np.linalg.lstsq(weights[:, 1:3], rest, rcond=None)[0]
    return np.concatenate([ends[:1], middle, ends[1:]])
