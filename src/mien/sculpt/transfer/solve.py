"""Deformation transfer (Sumner and Popović 2004) of displacement fields, factored once.

    minimise  sum_T area w |grad u - G|²  +  sum_v area (trust / L²) |u - c|²

with G the source's displacement gradient at each target triangle T, w the trust in its partner, and
c the source's displacement at each vertex's partner. The second sum is the screen: without it thin
strips such as lids drift, for gradients add up. Both G and c are linear in the source's motion and
alike in x, y and z, so that all of it is one sparse matrix and one factored system: a shape costs
a product and three solutions.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from mien.face.face import Array, Ints
from mien.sculpt.transfer.correspondence import Correspondence
from mien.sculpt.transfer.skin import Skin

_SCREEN = 10.0
"""mm, the screen's length L: over less, gradients rule; over more, places."""
_ROUNDS = 3
"""Smoothings of the source's gradients over its neighbours."""
_DOUBT = 0.03
"""Weight of a triangle without a partner."""
_STILL = 0.15
"""mm: where the partner moves less in every shape, the target stays."""
_HELD = 1e3
"""Weight that holds a vertex, in areas."""
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
    matrix = sparse.csr_matrix(
        (slopes.ravel(), (rows.ravel(), columns.ravel())), (3 * count, len(vertices))
    )
    return matrix, double / 2.0


class Transfer:
    """From motion of a source skin (S vertices) to motion of a target skin (V vertices)."""

    def __init__(
        self,
        source: Skin,
        target: Skin,
        pair: Correspondence,
        moved: Array,
        screen: float = _SCREEN,
    ) -> None:
        """Skins at rest; ``moved`` (S,) mm, the farthest that any shape takes each vertex of the
        source, at the target's size."""
        self._similarity = pair.similarity
        slopes, areas = gradient(target.vertices, target.triangles)
        trust = pair.trust[target.triangles].mean(axis=1)
        weight = np.repeat(areas * (_DOUBT + (1.0 - _DOUBT) * trust), 3)
        read = self._read(source, target.triangles, pair.partner)
        believed = sparse.diags(np.repeat(trust, 3)) @ read
        own_area = np.zeros(len(target.vertices))
        np.add.at(own_area, target.triangles, areas[:, None] / 3.0)
        held = pair.partner @ moved < _STILL
        screened = own_area * np.where(held, _HELD, pair.trust / screen**2)
        weighed = slopes.T @ sparse.diags(weight)
        place = sparse.diags(np.where(held, 0.0, screened)) @ pair.partner
        self._right = (weighed @ believed + place).tocsr()
        system = (weighed @ slopes + sparse.diags(screened + 1e-9)).tocsc()
        self._solver = splu(
            system, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )  # fmt: skip
        self.held: NDArray[np.bool_] = held

    def _read(
        self, source: Skin, target_triangles: Ints, partner: sparse.csr_matrix
    ) -> sparse.csr_matrix:
        """(3T, S) gradients of the source, smoothed, at the middles of the target's triangles."""
        triangles, count = source.triangles, len(source.vertices)
        slopes, areas = gradient(self._similarity(source.vertices), triangles)
        corner = sparse.csr_matrix(
            (np.repeat(areas, 3), (triangles.ravel(), np.repeat(np.arange(len(triangles)), 3))),
            (count, len(triangles)),
        )
        mean = _rows_to_one(corner)
        near = sparse.csr_matrix(
            (
                np.ones(6 * len(triangles)),
                (
                    triangles[:, [0, 1, 2, 1, 2, 0]].ravel(),
                    triangles[:, [1, 2, 0, 0, 1, 2]].ravel(),
                ),
            ),
            (count, count),
        )
        near.data[:] = 1.0
        smooth = 0.5 * (_rows_to_one(near) + sparse.identity(count))
        middle = sparse.csr_matrix(
            (
                np.full(3 * len(target_triangles), 1.0 / 3.0),
                (np.repeat(np.arange(len(target_triangles)), 3), target_triangles.ravel()),
            ),
            (len(target_triangles), partner.shape[0]),
        )
        at = middle @ partner
        for _ in range(_ROUNDS):
            at = at @ smooth
        return sparse.kron(at @ mean, sparse.identity(3), format="csr") @ slopes

    def __call__(self, motion: Array) -> Array:
        """Motion (K, V, 3) of the target for ``motion`` (K, S, 3) of the source."""
        turned = self._similarity.scale * motion @ self._similarity.rotation.T
        shapes = []
        for first in range(0, len(turned), _AT_ONCE):
            run = turned[first : first + _AT_ONCE]
            columns = run.transpose(1, 0, 2).reshape(run.shape[1], -1)
            solved = self._solver.solve(self._right @ columns)
            shapes.append(solved.reshape(len(solved), len(run), 3).transpose(1, 0, 2))
        return np.concatenate(shapes)


def _rows_to_one(matrix: sparse.csr_matrix) -> sparse.csr_matrix:
    total = np.asarray(matrix.sum(axis=1)).ravel()
    return sparse.diags(1.0 / np.maximum(total, 1e-12)) @ matrix
