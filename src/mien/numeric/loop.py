"""Loop's subdivision of triangle meshes (C. Loop, Smooth Subdivision Surfaces Based on
Triangles, 1987), with Warren's weights, as one sparse matrix."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

Index = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Subdivision:
    """One step: ``fine = matrix @ coarse``."""

    matrix: sparse.csr_matrix
    """(V + E, V); the coarse vertices come first, in their order."""
    triangles: Index
    """(4 T, 3) wound as the coarse ones."""
    edges: Index
    """(E, 2) ends, in rising order, of the coarse edge each new vertex sits on."""


def subdivide(triangles: Index, vertices: int) -> Subdivision:
    """One Loop step on a mesh of ``vertices`` vertices; open edges keep to their own curve."""
    corners = [triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]
    edges, row, uses = np.unique(
        np.sort(np.concatenate(corners), axis=1), axis=0, return_inverse=True, return_counts=True
    )
    row = row.ravel()
    opposite = np.concatenate([triangles[:, 2], triangles[:, 0], triangles[:, 1]])
    matrix = sparse.vstack(
        [
            _vertex_rule(edges, uses == 1, vertices),
            _edge_rule(edges, uses == 1, row, opposite, vertices),
        ]
    ).tocsr()
    return Subdivision(matrix, _quartered(triangles, vertices + row), edges)


def _vertex_rule(edges: Index, open_edge: NDArray[np.bool_], count: int) -> sparse.coo_matrix:
    on_rim = np.zeros(count, bool)
    on_rim[edges[open_edge]] = True
    valence = np.bincount(edges.ravel(), minlength=count)
    beta = np.where(valence == 3, 3 / 16, 3 / (8 * np.maximum(valence, 1)))
    own = np.where(on_rim, 0.75, 1 - valence * beta)
    rows, columns, weights = [np.arange(count)], [np.arange(count)], [own]
    for here, there in ((0, 1), (1, 0)):
        inner = ~on_rim[edges[:, here]]
        for chosen, weight in (
            (inner, beta[edges[:, here]]),
            (open_edge, np.full(len(edges), 1 / 8)),
        ):
            rows.append(edges[chosen, here])
            columns.append(edges[chosen, there])
            weights.append(weight[chosen])
    return _matrix(rows, columns, weights, (count, count))


def _edge_rule(
    edges: Index, open_edge: NDArray[np.bool_], row: Index, opposite: Index, count: int
) -> sparse.coo_matrix:
    number = np.arange(len(edges))
    end = np.where(open_edge, 1 / 2, 3 / 8)
    inner = ~open_edge[row]
    rows = [number, number, row[inner]]
    columns = [edges[:, 0], edges[:, 1], opposite[inner]]
    weights = [end, end, np.full(int(inner.sum()), 1 / 8)]
    return _matrix(rows, columns, weights, (len(edges), count))


def _quartered(triangles: Index, middles: Index) -> Index:
    first, second, third = np.split(middles, 3)
    a, b, c = triangles.T
    quarters = [(a, first, third), (b, second, first), (c, third, second), (first, second, third)]
    return np.concatenate([np.stack(quarter, axis=1) for quarter in quarters])


def _matrix(
    rows: list[Index],
    columns: list[Index],
    weights: list[NDArray[np.float64]],
    shape: tuple[int, int],
) -> sparse.coo_matrix:
    where = (np.concatenate(rows), np.concatenate(columns))
    return sparse.coo_matrix((np.concatenate(weights), where), shape)
