"""The nearest points of a triangle mesh."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

Array = NDArray[np.float64]
Ints = NDArray[np.int32]

_NEIGHBOURS = 24
"""Triangles looked at for each point: those whose middles are nearest."""


def closest_on_triangles(points: Array, a: Array, b: Array, c: Array) -> Array:
    """(..., 3) barycentric weights of the places on triangles (..., 3) that are nearest to
    ``points`` (..., 3); Ericson, Real-Time Collision Detection (2005), 5.1.5."""
    ab, ac, bc = b - a, c - a, c - b
    along_ab = _along(points - a, ab)
    along_ac = _along(points - a, ac)
    along_bc = _along(points - b, bc)
    zero = np.zeros_like(along_ab)
    edges = np.stack(
        [
            np.stack([1 - along_ab, along_ab, zero], axis=-1),
            np.stack([1 - along_ac, zero, along_ac], axis=-1),
            np.stack([zero, 1 - along_bc, along_bc], axis=-1),
            _inside(points - a, ab, ac),
        ]
    )
    places = edges[..., :1] * a + edges[..., 1:2] * b + edges[..., 2:] * c
    distance = np.linalg.norm(places - points, axis=-1)
    distance[3][(edges[3] < 0).any(axis=-1)] = np.inf
    best = np.argmin(distance, axis=0)
    return np.asarray(np.take_along_axis(edges, best[None, ..., None], axis=0)[0])


def nearest(points: Array, vertices: Array, triangles: Ints) -> tuple[NDArray[np.intp], Array]:
    """Triangle (N,) and barycentric weights (N, 3) nearest to each of ``points`` (N, 3), among
    the triangles whose middles are near."""
    middles = vertices[triangles].mean(axis=1)
    _, near = cKDTree(middles).query(points, k=min(_NEIGHBOURS, len(triangles)))
    near = np.asarray(near).reshape(len(points), -1)
    a, b, c = (vertices[triangles[near, corner]] for corner in range(3))
    weights = closest_on_triangles(points[:, None], a, b, c)
    places = weights[..., :1] * a + weights[..., 1:2] * b + weights[..., 2:] * c
    best = np.argmin(np.linalg.norm(places - points[:, None], axis=-1), axis=1)
    rows = np.arange(len(points))
    return near[rows, best], weights[rows, best]


def _along(from_start: Array, edge: Array) -> Array:
    length = np.maximum((edge * edge).sum(axis=-1), 1e-30)
    return np.asarray(np.clip((from_start * edge).sum(axis=-1) / length, 0.0, 1.0))


def _inside(from_a: Array, ab: Array, ac: Array) -> Array:
    """Barycentric weights of the foot in the triangle's plane; negative outside it."""
    d00, d01, d11 = (ab * ab).sum(-1), (ab * ac).sum(-1), (ac * ac).sum(-1)
    d20, d21 = (from_a * ab).sum(-1), (from_a * ac).sum(-1)
    area = d00 * d11 - d01 * d01
    safe = np.where(np.abs(area) > 1e-30, area, 1.0)
    v, w = (d11 * d20 - d01 * d21) / safe, (d00 * d21 - d01 * d20) / safe
    v = np.where(np.abs(area) > 1e-30, v, -1.0)
    return np.stack([1.0 - v - w, v, w], axis=-1)
