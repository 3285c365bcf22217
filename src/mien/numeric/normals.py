"""Normals of triangle meshes."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int32]


def vertex_normals(vertices: Array, triangles: Ints) -> Array:
    """Unit normals (V, 3), each the mean of its triangles' weighted by area; zero where a vertex
    has none. ``vertices`` (V, 3), ``triangles`` (T, 3) counter-clockwise seen from outside."""
    normals = np.zeros((len(vertices), 3))
    add_normals(np.ascontiguousarray(vertices, dtype=np.float64), triangles, normals)
    return normals


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def add_normals(vertices: Array, triangles: Ints, normals: Array) -> None:
    """As ``vertex_normals``, into ``normals`` (V, 3), which must come zeroed."""
    for t in range(triangles.shape[0]):
        i, j, k = triangles[t, 0], triangles[t, 1], triangles[t, 2]
        ax = vertices[j, 0] - vertices[i, 0]
        ay = vertices[j, 1] - vertices[i, 1]
        az = vertices[j, 2] - vertices[i, 2]
        bx = vertices[k, 0] - vertices[i, 0]
        by = vertices[k, 1] - vertices[i, 1]
        bz = vertices[k, 2] - vertices[i, 2]
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        for v in (i, j, k):
            normals[v, 0] += x
            normals[v, 1] += y
            normals[v, 2] += z
    for v in range(normals.shape[0]):
        length = np.sqrt(normals[v, 0] ** 2 + normals[v, 1] ** 2 + normals[v, 2] ** 2)
        if length > 0.0:
            normals[v, 0] /= length
            normals[v, 1] /= length
            normals[v, 2] /= length
