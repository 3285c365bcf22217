"""Cubic Bezier curves of four control points, sampled at many places at once."""

from __future__ import annotations

from functools import cache

import numpy as np
from numba import njit
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
    return np.asarray(_fit(np.ascontiguousarray(places, dtype=float)))


@njit(cache=True, nogil=True)
def _fit(places: Array) -> Array:
    count = len(places)
    at = np.zeros(count)
    for n in range(1, count):
        x, y = places[n, 0] - places[n - 1, 0], places[n, 1] - places[n - 1, 1]
        at[n] = at[n - 1] + np.sqrt(x * x + y * y)
    whole = max(at[-1], 1e-12)
    near_near = near_far = far_far = 0.0
    right = np.zeros((2, 2))
    for n in range(count):
        s = at[n] / whole
        r = 1.0 - s
        near, far = 3.0 * r * r * s, 3.0 * r * s * s
        near_near += near * near
        near_far += near * far
        far_far += far * far
        for axis in range(2):
            rest = places[n, axis] - r * r * r * places[0, axis] - s * s * s * places[-1, axis]
            right[0, axis] += near * rest
            right[1, axis] += far * rest
    inverse = 1.0 / max(near_near * far_far - near_far * near_far, 1e-12)
    control = np.empty((4, 2))
    for axis in range(2):
        control[0, axis], control[3, axis] = places[0, axis], places[-1, axis]
        control[1, axis] = inverse * (far_far * right[0, axis] - near_far * right[1, axis])
        control[2, axis] = inverse * (near_near * right[1, axis] - near_far * right[0, axis])
    return control
