"""How much a displacement of a triangle mesh bends it: the thin plate on any triangulation.

    |d|²_bending = size sum over vertices area_i |(L d)_i|²,    L = M⁻¹ K

with K the cotangent weights (Pinkall and Polthier, Computing Discrete Minimal Surfaces, 1993) and
M a third of the triangles round each vertex. Unlike the uniform Laplacian it counts a field linear
over a flat mesh as straight, however uneven its triangles.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

Array = NDArray[np.float64]

_STEEPEST = 20.0
"""Largest cotangent: beyond, slivers make weights that no solver likes."""
_SMALLEST = 0.2
"""Least area of a vertex, of the median: the reciprocal of a sliver's rules the whole mesh."""


def stiffness(vertices: Array, triangles: NDArray[Any]) -> tuple[sparse.csr_matrix, Array]:
    """K (V, V), whose rows sum to zero, and the area (V,) about each vertex."""
    count = len(vertices)
    corners = vertices[triangles]
    area = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    edges = sparse.csr_matrix((count, count))
    for k in range(3):
        here, first, second = (corners[:, (k + i) % 3] for i in range(3))
        cosine = np.einsum("tx,tx->t", first - here, second - here)
        weight = 0.5 * np.clip(cosine / np.maximum(2.0 * area, 1e-12), -_STEEPEST, _STEEPEST)
        ends = triangles[:, (k + 1) % 3], triangles[:, (k + 2) % 3]
        edges = edges + sparse.csr_matrix((weight, ends), (count, count))
    edges = edges + edges.T
    shares = np.zeros(count)
    np.add.at(shares, triangles, area[:, None] / 3.0)
    return (sparse.diags(np.asarray(edges.sum(axis=1)).ravel()) - edges).tocsr(), shares


def bending(vertices: Array, triangles: NDArray[Any]) -> sparse.csc_matrix:
    """(V, V) such that d' B d is the bending of a field d (V,), symmetric, at least zero. It is
    multiplied by the mean area of a vertex: a mesh and its enlargement bend alike."""
    weights, area = stiffness(vertices, triangles)
    area = np.maximum(area, _SMALLEST * np.median(area))
    return (area.mean() * weights @ sparse.diags(1.0 / area) @ weights).tocsc()


def factor(matrix: sparse.spmatrix) -> Any:
    """A solver of ``matrix``, which must be symmetric and positive definite. Other orderings take
    up to fifty times as long on meshes."""
    return splu(
        matrix.tocsc(),
        permc_spec="MMD_AT_PLUS_A",
        options={"SymmetricMode": True},
        diag_pivot_thresh=0.0,
    )
