"""The normal equations of a head fit, frame by frame, without ever laying out a Jacobian.

The residual of a point is r = m Y_z - Y_xy with Y = R X + t (see ``headfit``), its unknowns are a
left rotation increment about the head's origin, the translation and the weights. One pass that
stays in the processor's cache is four times as fast as laying the Jacobian out.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


@njit(cache=True, nogil=True, error_model="numpy")
def accumulate(
    neutral: Array,
    shapes: Array,
    rays: Array,
    rotation: Array,
    translation: Array,
    weights: Array,
    sigma: float,
    knee: float,
) -> tuple[Array, Array]:
    """J' W J (F, U, U) and -J' W r (F, U) of U = 6 + K unknowns.

    ``neutral`` (N, 3), ``shapes`` (N, 3, K), ``rays`` (F, N, 2), ``rotation`` (F, 3, 3),
    ``translation`` (F, 3), ``weights`` (F, K). W are Cauchy weights of ``knee`` ``sigma``s.
    """
    frames, points, count = len(rays), len(neutral), shapes.shape[2]
    unknowns = 6 + count
    normal = np.zeros((frames, unknowns, unknowns))
    right = np.zeros((frames, unknowns))
    across, down = np.zeros(unknowns), np.zeros(unknowns)
    across[3], down[4] = -1.0, -1.0
    turned = np.empty(3)
    for f in range(frames):
        turn, step, level = rotation[f], translation[f], weights[f]
        for n in range(points):
            u, v = rays[f, n, 0], rays[f, n, 1]
            for i in range(3):
                turned[i] = 0.0
                for j in range(3):
                    place = neutral[n, j]
                    for k in range(count):
                        place += level[k] * shapes[n, j, k]
                    turned[i] += turn[i, j] * place
            depth = turned[2] + step[2]
            miss_across = u * depth - turned[0] - step[0]
            miss_down = v * depth - turned[1] - step[1]
            far = (miss_across**2 + miss_down**2) / sigma**2
            trust = 1.0 / (1.0 + far / knee**2) / sigma**2
            across[0], down[0] = u * turned[1], v * turned[1] + turned[2]
            across[1], down[1] = -u * turned[0] - turned[2], -v * turned[0]
            across[2], down[2] = turned[1], -turned[0]
            across[5], down[5] = u, v
            a0, a1, a2 = (
                u * turn[2, 0] - turn[0, 0],
                u * turn[2, 1] - turn[0, 1],
                u * turn[2, 2] - turn[0, 2],
            )
            d0, d1, d2 = (
                v * turn[2, 0] - turn[1, 0],
                v * turn[2, 1] - turn[1, 1],
                v * turn[2, 2] - turn[1, 2],
            )
            for k in range(count):
                x, y, z = shapes[n, 0, k], shapes[n, 1, k], shapes[n, 2, k]
                across[6 + k] = a0 * x + a1 * y + a2 * z
                down[6 + k] = d0 * x + d1 * y + d2 * z
            for row in range(unknowns):
                heavy_across, heavy_down = trust * across[row], trust * down[row]
                right[f, row] -= heavy_across * miss_across + heavy_down * miss_down
                for column in range(row + 1):
                    normal[f, row, column] += (
                        heavy_across * across[column] + heavy_down * down[column]
                    )
        for row in range(unknowns):
            normal[f, :row, row] = normal[f, row, :row]
    return normal, right
