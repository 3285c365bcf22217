"""A lens: two cubic Bezier curves, upper and lower, that share both ends.

Brows, eyes, nostrils, lips and mouth opening are all of this form. Six points (6, 2): the end on
the picture's left, the end on its right, the two middle points of the upper curve from left to
right, those of the lower one. Units are patch units (see ``patch``), y down.
"""

from __future__ import annotations

from functools import cache
from math import hypot

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.numeric import bezier

Array = NDArray[np.float64]

UPPER: NDArray[np.intp] = np.array([0, 2, 3, 1])
"""Points of a lens that are the control points of its upper curve."""
LOWER: NDArray[np.intp] = np.array([0, 4, 5, 1])


def fit_lens(upper: Array, lower: Array) -> Array:
    """(6, 2) the lens of least squares on an upper and a lower edge (N, 2) and (M, 2), both from
    the picture's left to its right."""
    ends = 0.5 * (upper[[0, -1]] + lower[[0, -1]])
    curves = [
        bezier.fit(np.concatenate([ends[:1], edge[1:-1], ends[1:]])) for edge in (upper, lower)
    ]
    return np.concatenate([ends, curves[0][1:3], curves[1][1:3]])


def upper_curve(lens: Array, samples: int = 21) -> Array:
    """(..., S, 2) the upper edge of lenses (..., 6, 2)."""
    return np.asarray(_shares(samples)[0] @ lens)


def lower_curve(lens: Array, samples: int = 21) -> Array:
    """(..., S, 2) the lower edge."""
    return np.asarray(_shares(samples)[1] @ lens)


def outline(lens: Array, samples: int = 21) -> Array:
    """(..., 2 S, 2) round the lens once: along the top and back below."""
    return np.asarray(_shares(samples)[2] @ lens)


@cache
def _shares(samples: int) -> tuple[Array, Array, Array]:
    """(S, 6), (S, 6) and (2 S, 6) what each point of a lens counts along its upper and its lower
    edge, and round it."""
    upper, lower = np.zeros((2, samples, 6))
    upper[:, UPPER] = lower[:, LOWER] = bezier.bernstein(np.linspace(0.0, 1.0, samples))
    return upper, lower, np.concatenate([upper, lower[::-1]])


def height(lens: Array) -> Array:
    """(...) greatest distance between the curves, upright to the chord."""
    chord = lens[..., 1, :] - lens[..., 0, :]
    down = np.stack([-chord[..., 1], chord[..., 0]], axis=-1)
    down /= np.maximum(np.linalg.norm(chord, axis=-1, keepdims=True), 1e-6)
    apart = lower_curve(lens) - upper_curve(lens)
    return np.asarray((apart * down[..., None, :]).sum(-1).max(-1))


@njit(cache=True, nogil=True)
def tallness(lens: Array) -> float:
    """``height`` of one lens (6, 2), for the inside of a loop."""
    x, y = lens[1, 0] - lens[0, 0], lens[1, 1] - lens[0, 1]
    length = max(np.sqrt(x * x + y * y), 1e-6)
    most = -np.inf
    for k in range(21):
        s = k / 20.0
        near, far = 3.0 * (1.0 - s) ** 2 * s, 3.0 * (1.0 - s) * s**2
        across = near * (lens[4, 0] - lens[2, 0]) + far * (lens[5, 0] - lens[3, 0])
        down = near * (lens[4, 1] - lens[2, 1]) + far * (lens[5, 1] - lens[3, 1])
        most = max(most, (down * x - across * y) / length)
    return most


def boxed(left: Array, right: Array, top: float, bottom: float) -> Array:
    """(6, 2) the lens between two ends that reaches from ``top`` above their chord to ``bottom``
    below it: the initial guess from a blob's box. A round shape has its middle points at the
    ends, a flat one at a quarter of the chord."""
    x, y = (right - left).tolist()
    width = max(hypot(x, y), 1e-6)
    inset = 0.25 * min(max(2.0 - (top + bottom) / (0.35 * width), 0.0), 1.0)
    rise, fall = -4.0 / 3.0 * top / width, 4.0 / 3.0 * bottom / width
    (a, b), (c, d) = left.tolist(), right.tolist()
    near, far = (a + inset * x, b + inset * y), (c - inset * x, d - inset * y)
    middles = [(u - h * y, v + h * x) for h in (rise, fall) for u, v in (near, far)]
    return np.array([(a, b), (c, d), *middles])
