"""Deformation transfer (Sumner and Popović 2004) of displacement fields, factored once.

    minimise  sum_T area w |grad u - G|²  +  sum_v area (trust / L²) |u - c|²

with G the displacement gradient of the source, laid on the target, at each target triangle T, w the
trust in its partner, and c the source's displacement at each vertex's partner. The second sum is
the screen: without it thin strips such as lids drift, for gradients add up. Both G and c are linear
in the source's motion and alike in x, y and z, so that all of it is one sparse matrix and one
factored system: a shape costs a product and three solutions.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from mien.face.face import Array, Ints
from mien.sculpt.transfer.correspondence import Correspondence
from mien.sculpt.transfer.skin import Skin

_SCREEN = 8.0
"""mm, the screen's length L: over less, gradients rule; over more, places. (Among people of one
maker less is better, between heads of two makers it makes no difference.)"""
_ROUNDS = 3
"""Smoothings of the source's gradients over its neighbours."""
_DOUBT = 0.03
"""Weight of a triangle without a partner."""
_STILL = 0.15
"""mm: where the partner moves less in every shape, the target stays."""
_HELD = 1e3
"""Weight that holds a vertex, in areas."""
_LOOSE = 1e-9
"""Weight that keeps a piece which nothing holds from floating."""
_AT_ONCE = 8
"""Shapes solved together, which bounds memory."""


def gradient(vertices: Array, triangles: Ints) -> tuple[sparse.csr_matrix, Array]:
    """(3T, V) gradients of the function that is linear on each triangle, rows x y z of the first,
    then of the next; and the areas (T,)."""
    a, b, c = (vertices[triangles[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    double = np.maximum(np.linalg.norm(normal, axis=1), 1e-9)
    unit = normal / double[:, None]
    slopes = np.stack(
        [np.cross(unit, edge) / double[:, None] for edge in (c - b, a - c, b - a)], axis=1
    )
    count = len(triangles)
    rows = np.repeat(np.arange(3 * count).reshape(count, 1, 3), 3, axis=1)
    columns = np.repeat(triangles[:, :, None], 3, axis=2)
    shape = (3 * count, len(vertices))
    return sparse.csr_matrix((slopes.ravel(), (rows.ravel(), columns.ravel())), shape), double / 2


class Transfer:
    """From motion of a source skin (S vertices) to motion of a target skin (N vertices)."""

    def __init__(
        self,
        source: Skin,
        target: Skin,
        pair: Correspondence,
        moved: Array,
        screen: float = _SCREEN,
    ) -> None:
        """Skins at rest; ``moved`` (S,) mm, the farthest that any shape takes each vertex of the
        source."""
        self._scale = pair.scale[:, None]
        slopes, areas = gradient(target.vertices, target.triangles)
        trust = pair.trust[target.triangles].mean(axis=1)
        weight = np.repeat(areas * (_DOUBT + (1.0 - _DOUBT) * trust), 3)
        wanted = sparse.diags(np.repeat(trust, 3)) @ _read_gradients(source, target, pair)
        area = np.zeros(len(target.vertices))
        np.add.at(area, target.triangles, areas[:, None] / 3.0)
        held = pair.partner @ (pair.scale * moved) < _STILL
        screened = area * np.where(held, _HELD, pair.trust / screen**2)
        weighed = slopes.T @ sparse.diags(weight)
        places = sparse.diags(np.where(held, 0.0, screened)) @ pair.partner
        self._right = (weighed @ wanted + places).tocsr()
        system = (weighed @ slopes + sparse.diags(screened + _LOOSE)).tocsc()
        self._solver = splu(
            system,
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )

    def __call__(self, motion: Array) -> Array:
        """Motion (K, N, 3) of the target for ``motion`` (K, S, 3) of the source."""
        shapes = []
        for first in range(0, len(motion), _AT_ONCE):
            run = self._scale * motion[first : first + _AT_ONCE]
            columns = run.transpose(1, 0, 2).reshape(run.shape[1], -1)
            solved = self._solver.solve(self._right @ columns)
            shapes.append(solved.reshape(len(solved), len(run), 3).transpose(1, 0, 2))
        return np.concatenate(shapes)


def _read_gradients(source: Skin, target: Skin, pair: Correspondence) -> sparse.csr_matrix:
    """(3T, S) gradients of the source, smoothed, at the middles of the target's triangles."""
    slopes, areas = gradient(pair.warped, source.triangles)
    at_vertices = _mean(_around(source.triangles, areas, len(pair.warped)))
    near = _around(source.triangles, np.ones_like(areas), len(pair.warped))
    near = _mean(near @ near.T)
    at = _around(target.triangles, np.full(len(target.triangles), 1.0 / 3.0), len(target.vertices))
    read = at.T @ pair.partner
    for _ in range(_ROUNDS):
        read = read @ near
    return sparse.kron(read @ at_vertices, sparse.identity(3), format="csr") @ slopes


def _around(triangles: Ints, values: NDArray[np.float64], vertices: int) -> sparse.csr_matrix:
    """(V, T) ``values`` (T,) of the triangles about each vertex."""
    columns = np.repeat(np.arange(len(triangles)), 3)
    shape = (vertices, len(triangles))
    return sparse.csr_matrix((np.repeat(values, 3), (triangles.ravel(), columns)), shape)


def _mean(matrix: sparse.csr_matrix) -> sparse.csr_matrix:
    """``matrix`` with rows that sum to one."""
    total = np.asarray(matrix.sum(axis=1)).ravel()
    return sparse.diags(1.0 / np.maximum(total, 1e-12)) @ matrix
