"""The loops of a head fit: a first pose in closed form, and Gauss-Newton on pose and shapes.

A frame has a few dozen points. Array operations so small take longer to begin than to end, and
live work waits for each.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.capture.normal_equations import accumulate
from mien.numeric.positive import eliminate
from mien.numeric.rotation import rodrigues

Array = NDArray[np.float64]

_PRESSED = 1e9
"""What is added to the diagonal of a weight that rests at its bound."""


@njit(cache=True, nogil=True)
def first_pose(neutral: Array, rays: Array) -> tuple[Array, Array]:
    """Rotations (F, 3, 3) and translations (F, 3) mm of points ``neutral`` (N, 3) seen as ``rays``
    (F, N, 2): the scaled-orthographic pose (DeMenthon and Davis 1995, first iteration)."""
    frames, points = rays.shape[:2]
    rotation, translation = np.empty((frames, 3, 3)), np.empty((frames, 3))
    centre = np.array([neutral[:, i].mean() for i in range(3)])
    lift = np.linalg.pinv(neutral - centre)
    for f in range(frames):
        across, down = rays[f, :, 0].mean(), rays[f, :, 1].mean()
        axes = np.zeros((2, 3))
        for n in range(points):
            for i in range(3):
                axes[0, i] += lift[i, n] * (rays[f, n, 0] - across)
                axes[1, i] += lift[i, n] * (rays[f, n, 1] - down)
        left, size, right = np.linalg.svd(axes, False)
        rotation[f, :2] = left @ right
        x, y = rotation[f, 0], rotation[f, 1]
        for i in range(3):
            j, k = (i + 1) % 3, (i + 2) % 3
            rotation[f, 2, i] = x[j] * y[k] - x[k] * y[j]
        depth = 2.0 / (size[0] + size[1])
        translation[f] = np.array([across * depth, down * depth, depth]) - rotation[f] @ centre
    return rotation, translation


@njit(cache=True, nogil=True)
def descend(
    neutral: Array,
    shapes: Array,
    rays: Array,
    rotation: Array,
    translation: Array,
    weights: Array,
    trust: tuple[float, float],
    prior: tuple[float, float],
    rounds: int,
) -> None:
    """``rounds`` steps of Gauss-Newton, in the place of ``rotation`` (F, 3, 3), ``translation``
    (F, 3) and ``weights`` (F, K). Arrays as ``accumulate`` takes them, ``trust`` its sigma and
    knee; ``prior`` is the precision of a weight and its bound. Raises LinAlgError where a frame's
    points tell no pose."""
    for _ in range(rounds):
        normal, right = accumulate(
            neutral, shapes, rays, rotation, translation, weights, trust[0], trust[1]
        )
        for f in range(len(rays)):
            _bound(normal[f], right[f], weights[f], prior[0], prior[1])
            eliminate(normal[f], right[f])
            rotation[f] = rodrigues(right[f : f + 1, :3])[0] @ rotation[f]
            translation[f] += right[f, 3:6]
            for k in range(weights.shape[1]):
                weights[f, k] = min(max(weights[f, k] + right[f, 6 + k], 0.0), prior[1])


@njit(cache=True, nogil=True)
def _bound(normal: Array, right: Array, weights: Array, precision: float, most: float) -> None:
    """Add the prior; weights that press against a bound rest there."""
    for k in range(len(weights)):
        right[6 + k] -= precision * weights[k]
        down = weights[k] <= 0.0 and right[6 + k] < 0.0
        up = weights[k] >= most and right[6 + k] > 0.0
        normal[6 + k, 6 + k] += precision + (_PRESSED if down or up else 0.0)
