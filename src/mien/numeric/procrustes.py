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


def rigid(points: Array, onto: Array, weights: Array | None = None) -> Similarity:
    """The turn and shift of least squares that take ``points`` (N, 3) ``onto`` (N, 3), each
    counted by its weight (N,). Raises ValueError as ``align``."""
    points, onto = np.asarray(points, dtype=float), np.asarray(onto, dtype=float)
    if points.shape != onto.shape or len(points) < 3:
        raise ValueError(f"cannot align {points.shape} points onto {onto.shape}")
    share = np.ones(len(points)) if weights is None else np.asarray(weights, dtype=float)
    share = share / share.sum()
    from_mean, to_mean = share @ points, share @ onto
    left, _, right = np.linalg.svd((share[:, None] * (onto - to_mean)).T @ (points - from_mean))
    rotation = (left * [1.0, 1.0, np.sign(np.linalg.det(left @ right))]) @ right
    return Similarity(1.0, rotation, to_mean - rotation @ from_mean)


def rigid_part(points: Array, onto: Array, scale: float, rounds: int = 20) -> Similarity:
    """The turn and shift that hold for most of ``points`` (N, 3): those that miss by more than
    about ``scale`` count ever less (Geman and McClure), starting from all alike."""
    pose = rigid(points, onto)
    # From wide to narrow, lest a small part that agrees by chance is taken for the head.
    for width in np.maximum(scale, scale * 2.0 ** np.arange(rounds // 3, rounds // 3 - rounds, -1)):
        missed = ((pose(points) - onto) ** 2).sum(axis=1)
        pose = rigid(points, onto, (width**2 / (width**2 + missed)) ** 2)
    return pose
