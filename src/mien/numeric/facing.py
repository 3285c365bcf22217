"""The nearest place on a triangle mesh that faces the same way, for many queries of one mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy import sparse
from scipy.spatial import cKDTree

Array = NDArray[np.float64]
Ints = NDArray[np.int32]

_NEAR = 8
"""Vertices about a query whose triangles are tried."""


@dataclass(frozen=True, slots=True)
class Closest:
    """Where N queries found their nearest place."""

    triangle: Ints
    """(N,)"""
    weights: Array
    """(N, 3) barycentric."""
    distance: Array
    """(N,) without what a turned normal cost."""
    facing: Array
    """(N,) cosine between the query's normal and the triangle's; 0 where no normal was given."""

    def matrix(self, triangles: Ints, vertices: int) -> sparse.csr_matrix:
        """(N, V) takes values at the mesh's vertices to the nearest places."""
        rows = np.repeat(np.arange(len(self.triangle)), 3)
        corners = triangles[self.triangle].ravel()
        shape = (len(self.triangle), vertices)
        return sparse.csr_matrix((self.weights.ravel(), (rows, corners)), shape)


class ClosestPoints:
    """A mesh that is asked many times. ``vertices`` (V, 3), ``triangles`` (T, 3)."""

    def __init__(self, vertices: Array, triangles: Ints) -> None:
        self._vertices = np.ascontiguousarray(vertices, dtype=np.float64)
        self._triangles = np.ascontiguousarray(triangles, dtype=np.int32)
        self._used = np.unique(triangles)
        self._tree = cKDTree(self._vertices[self._used])
        corners = self._triangles.ravel()
        order = np.argsort(corners, kind="stable")
        self._around = (order // 3).astype(np.int32)
        self._first = np.searchsorted(corners[order], np.arange(len(vertices) + 1)).astype(np.int32)
        a, b, c = (self._vertices[self._triangles[:, k]] for k in range(3))
        normals = np.cross(b - a, c - a)
        self._normals = normals / np.maximum(np.linalg.norm(normals, axis=1), 1e-12)[:, None]

    def __call__(self, points: Array, normals: Array | None = None, turned: float = 0.0) -> Closest:
        """Nearest places of ``points`` (N, 3). With their unit ``normals`` (N, 3), a triangle
        that faces more than 60 degrees off counts as farther, by up to ``turned`` where it faces
        the other way."""
        near = min(_NEAR, len(self._used))
        _, found = self._tree.query(points, k=near)
        candidates = self._used[np.reshape(found, (len(points), near))].astype(np.int32)
        facing = np.zeros_like(points, dtype=float) if normals is None else normals
        triangle = np.zeros(len(points), np.int32)
        weights, distance = np.empty((len(points), 3)), np.empty(len(points))
        _search(
            np.ascontiguousarray(points, dtype=np.float64),
            np.ascontiguousarray(facing, dtype=np.float64),
            0.0 if normals is None else turned,
            candidates,
            self._first,
            self._around,
            self._vertices,
            self._triangles,
            self._normals,
            triangle,
            weights,
            distance,
        )
        cosine = np.einsum("ni,ni->n", facing, self._normals[triangle])
        return Closest(triangle, weights, distance, cosine)


@njit(cache=True, nogil=True, error_model="numpy")
def _search(
    points: Array,
    normals: Array,
    turned: float,
    candidates: Ints,
    first: Ints,
    around: Ints,
    vertices: Array,
    triangles: Ints,
    faces: Array,
    triangle: Ints,
    weights: Array,
    distance: Array,
) -> None:
    """For each point the best of the triangles ``around`` its ``candidates`` (N, C), into
    ``triangle``, ``weights`` and ``distance``."""
    for n in range(points.shape[0]):
        best = np.inf
        for c in range(candidates.shape[1]):
            v = candidates[n, c]
            for k in range(first[v], first[v + 1]):
                t = around[k]
                u, w, apart = _on_triangle(
                    points[n],
                    vertices[triangles[t, 0]],
                    vertices[triangles[t, 1]],
                    vertices[triangles[t, 2]],
                )
                cost = apart + turned * max(0.0, (0.5 - _dot(normals[n], faces[t])) / 1.5)
                if cost < best:
                    best = cost
                    triangle[n] = t
                    weights[n, 0] = 1.0 - u - w
                    weights[n, 1] = u
                    weights[n, 2] = w
                    distance[n] = apart


@njit(cache=True, nogil=True, error_model="numpy")
def _on_triangle(p: Array, a: Array, b: Array, c: Array) -> tuple[float, float, float]:
    """Barycentric weights of b and c at the place of the triangle nearest to ``p``, and its
    distance (Ericson, Real-Time Collision Detection, 2005, 5.1.5)."""
    ab, ac, ap = b - a, c - a, p - a
    bp, cp = p - b, p - c
    d1, d2, d3, d4 = _dot(ab, ap), _dot(ac, ap), _dot(ab, bp), _dot(ac, bp)
    d5, d6 = _dot(ab, cp), _dot(ac, cp)
    vc, vb, va = d1 * d4 - d3 * d2, d5 * d2 - d1 * d6, d3 * d6 - d5 * d4
    if d1 <= 0.0 and d2 <= 0.0:
        u, w = 0.0, 0.0
    elif d3 >= 0.0 and d4 <= d3:
        u, w = 1.0, 0.0
    elif vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        u, w = d1 / (d1 - d3), 0.0
    elif d6 >= 0.0 and d5 <= d6:
        u, w = 0.0, 1.0
    elif vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        u, w = 0.0, d2 / (d2 - d6)
    elif va <= 0.0 and d4 - d3 >= 0.0 and d5 - d6 >= 0.0:
        w = (d4 - d3) / ((d4 - d3) + (d5 - d6))
        u = 1.0 - w
    else:
        u, w = vb / (va + vb + vc), vc / (va + vb + vc)
    apart = ap - u * ab - w * ac
    return u, w, np.sqrt(_dot(apart, apart))


@njit(cache=True, nogil=True, inline="always")
def _dot(a: Array, b: Array) -> Any:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
