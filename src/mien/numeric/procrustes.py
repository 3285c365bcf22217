"""The similarity that brings one set of points onto another."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Similarity:
    """x -> scale * rotation @ x + shift."""

    scale: float
    rotation: Array
    """(3, 3)"""
    shift: Array
    """(3,)"""

    def __call__(self, points: Array) -> Array:
        """Points (..., 3) after the similarity."""
        return np.asarray(self.scale * points @ self.rotation.T + self.shift)


def align(points: Array, onto: Array) -> Similarity:
    """The similarity of least squares that takes ``points`` (N, 3) ``onto`` (N, 3).

    Umeyama 1991. Raises ValueError when the shapes differ or fewer than three points are given.
    """
    points, onto = np.asarray(points, dtype=float), np.asarray(onto, dtype=float)
    if points.shape != onto.shape or len(points) < 3:
        raise ValueError(f"cannot align {points.shape} points onto {onto.shape}")
    from_mean, to_mean = points.mean(0), onto.mean(0)
    left, size, right = np.linalg.svd((onto - to_mean).T @ (points - from_mean))
    proper = np.array([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
    rotation = (left * proper) @ right
    scale = float(size @ proper / ((points - from_mean) ** 2).sum())
    return Similarity(scale, rotation, to_mean - scale * rotation @ from_mean)
