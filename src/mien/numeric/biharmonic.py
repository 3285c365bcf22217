"""Spreading the displacement of a few handles smoothly over a mesh.

    minimise  |L d|² + stiffness / 6 sum over edges |d_i - d_j|² + sum of w |d_i - t_i|²

with L the uniform Laplacian of the mesh (six neighbours being the usual number): the thin plate of
Botsch and Kobbelt (An Intuitive Framework for Real-Time Freeform Modeling, 2004) with soft
constraints.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

Array = NDArray[np.float64]
Index = NDArray[np.intp]


def uniform_laplacian(triangles: Index, vertices: int) -> sparse.csr_matrix:
    """(V, V): each vertex less the mean of its neighbours."""
    here = triangles[:, [0, 1, 2, 1, 2, 0]].ravel()
    there = triangles[:, [1, 2, 0, 0, 1, 2]].ravel()
    near = sparse.csr_matrix((np.ones(len(here)), (here, there)), (vertices, vertices))
    near.data[:] = 1.0
    valence = np.asarray(near.sum(axis=1)).ravel()
    return (sparse.identity(vertices) - sparse.diags(1 / np.maximum(valence, 1)) @ near).tocsr()


class Handles:
    """Soft constraints: vertices, where each should go, and how much that matters. Several on
    one vertex are weighed against each other."""

    def __init__(self, vertices: int, dimensions: int = 3) -> None:
        self.weight = np.zeros(vertices)
        self.pull = np.zeros((vertices, dimensions))

    def add(self, vertices: ArrayLike, target: ArrayLike, weight: ArrayLike) -> None:
        """Ask for displacement ``target`` (3,) or (N, 3) at ``vertices`` (N,)."""
        rows = np.atleast_1d(np.asarray(vertices, dtype=np.intp)).ravel()
        weights = np.broadcast_to(np.asarray(weight, dtype=float), rows.shape)
        targets = np.broadcast_to(np.asarray(target, dtype=float), (len(rows), self.pull.shape[1]))
        np.add.at(self.weight, rows, weights)
        np.add.at(self.pull, rows, targets * weights[:, None])

    def hold(self, vertices: ArrayLike, weight: ArrayLike) -> None:
        """Ask ``vertices`` to stay."""
        self.add(vertices, np.zeros(self.pull.shape[1]), weight)


def spread(laplacian: sparse.csr_matrix, handles: Handles, stiffness: float) -> Array:
    """(V, D) displacement that follows the handles and is smooth between them."""
    valence = np.diff(laplacian.indptr) - 1
    tension = stiffness * sparse.diags(valence / 6) @ laplacian
    system = laplacian.T @ laplacian + tension + sparse.diags(handles.weight)
    return np.asarray(splu(system.tocsc()).solve(handles.pull))
