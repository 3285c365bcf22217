"""How the head is turned, from what is rigid: scaled orthography on the performer's own points.

    symbol                     name
    p = s (R X)_xy + t         place of a point in the patch, patch units
    X                          the point at rest: x right, y down, z away from the viewer

Near enough for where to look for features; the performance's own pose is perspective (headfit).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.numeric.positive import eliminate

Array = NDArray[np.float64]

_ROUNDS = 4
_STIFFNESS = 50.0
"""Squared patch units a squared radian by which a head's turn from one frame to the next costs."""


@dataclass(frozen=True, slots=True)
class Pose:
    """The head in the patch."""

    rotation: Array
    """(3, 3)"""
    scale: float
    shift: Array
    """(2,)"""

    def __call__(self, places: Array) -> Array:
        """(..., 2) patch units of points (..., 3) of the resting face."""
        return np.asarray(self.scale * places @ self.rotation[:2].T + self.shift)

    def levelled(self) -> tuple[Array, Pose]:
        """(2, 3) the similarity of the patch that undoes scale, roll and shift, and the pose in
        the patch after it."""
        roll = float(np.arctan2(self.rotation[1, 0], self.rotation[0, 0]))
        c, s = float(np.cos(roll)), float(np.sin(roll))
        turn = np.array([[c, s], [-s, c]])
        moved, rotation = np.empty((2, 3)), self.rotation.copy()
        moved[:, :2] = turn / self.scale
        moved[:, 2] = -moved[:, :2] @ self.shift
        rotation[:2] = turn @ rotation[:2]
        return moved, Pose(rotation, 1.0, np.zeros(2))


RESTING = Pose(np.eye(3), 1.0, np.zeros(2))


def fit_pose(rest: Array, seen: Array, weight: Array, knee: Array, start: Pose) -> Pose:
    """The pose that brings ``rest`` (N, 3) onto ``seen`` (N, 2), from ``start`` on: least squares
    with ``weight`` (N,), less by Cauchy's function from a miss of ``knee`` (N,) patch units on."""
    known = start.rotation, start.scale, start.shift
    rotation, scale, shift = _fit(rest, seen, weight, knee, *known)
    return Pose(rotation, scale, shift)


@njit(cache=True, nogil=True)
def _fit(
    rest: Array,
    seen: Array,
    weight: Array,
    knee: Array,
    rotation: Array,
    scale: float,
    shift: Array,
) -> tuple[Array, float, Array]:
    # Loops alone: what NumPy does for a kernel takes numba seconds to compile.
    turn, move, size = rotation.copy(), shift.copy(), scale
    row, column, right = np.zeros(6), np.zeros(6), np.zeros(6)
    row[4], column[5] = 1.0, 1.0
    normal, total = np.zeros((6, 6)), np.zeros(3)
    for _ in range(_ROUNDS):
        normal[:], right[:] = 0.0, 0.0
        for n in range(len(rest)):
            x = turn[0, 0] * rest[n, 0] + turn[0, 1] * rest[n, 1] + turn[0, 2] * rest[n, 2]
            y = turn[1, 0] * rest[n, 0] + turn[1, 1] * rest[n, 1] + turn[1, 2] * rest[n, 2]
            z = turn[2, 0] * rest[n, 0] + turn[2, 1] * rest[n, 1] + turn[2, 2] * rest[n, 2]
            miss_x = seen[n, 0] - size * x - move[0]
            miss_y = seen[n, 1] - size * y - move[1]
            trust = weight[n] / (1.0 + (miss_x**2 + miss_y**2) / knee[n] ** 2)
            row[0], row[1], row[2], row[3] = 0.0, size * z, -size * y, x
            column[0], column[1], column[2], column[3] = -size * z, 0.0, size * x, y
            for i in range(6):
                right[i] += trust * (row[i] * miss_x + column[i] * miss_y)
                for j in range(6):
                    normal[i, j] += trust * (row[i] * row[j] + column[i] * column[j])
        for i in range(2):
            normal[i, i] += _STIFFNESS
            right[i] -= _STIFFNESS * total[i]
        eliminate(normal, right)
        _turn(turn, right)
        for i in range(3):
            total[i] += right[i]
        size += right[3]
        move[0] += right[4]
        move[1] += right[5]
    return turn, size, move


@njit(cache=True, nogil=True)
def _turn(matrix: Array, vector: Array) -> None:
    """Turn the columns of ``matrix`` (3, 3) by the rotation vector in the first three numbers of
    ``vector`` (Rodrigues)."""
    angle = max(np.sqrt(vector[0] ** 2 + vector[1] ** 2 + vector[2] ** 2), 1e-12)
    x, y, z = vector[0] / angle, vector[1] / angle, vector[2] / angle
    c, s = np.cos(angle), np.sin(angle)
    for k in range(3):
        a, b, d = matrix[0, k], matrix[1, k], matrix[2, k]
        along = (1.0 - c) * (x * a + y * b + z * d)
        matrix[0, k] = c * a + s * (y * d - z * b) + along * x
        matrix[1, k] = c * b + s * (z * a - x * d) + along * y
        matrix[2, k] = c * d + s * (x * b - y * a) + along * z
