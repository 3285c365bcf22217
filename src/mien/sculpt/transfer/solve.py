"""Deformation transfer (Sumner and Popović 2004) of displacement fields, factored once.

    minimise  sum_T area w |grad u - G|²  +  sum_v area (trust / L²) |u - c|²
              + sum_v area (doubt / R²) |u|²

with G the displacement gradient of the source, laid on the target, at each target triangle T, w the
trust in its partner, and c the source's displacement at each vertex's partner. The second sum is
the screen: without it thin strips such as lids drift, for gradients add up. The third lets motion
fade over R where the source has nothing: a neck does not follow the corner of a mouth. Both G and c
are linear in the source's motion and alike in x, y and z: sparse matrices and one factored system,
and a shape costs a few products and three solutions.
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
_FADE = 30.0
"""mm, R: over which motion comes to rest on skin without a partner."""
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
        self._read = GradientReader(source, target, pair)
        slopes, areas = gradient(target.vertices, target.triangles)
        trust = pair.trust[target.triangles].mean(axis=1)
        weight = areas * (_DOUBT + (1.0 - _DOUBT) * trust)
        area = target.areas()
        held = pair.partner @ (pair.scale * moved) < _STILL
        placed = area * np.where(held, 0.0, pair.trust / screen**2)
        still = area * np.where(held, _HELD, _DOUBT * (1.0 - pair.trust) / _FADE**2)
        self._gathered = (slopes.T @ sparse.diags(np.repeat(weight * trust, 3))).tocsr()
        self._placed = sparse.diags(placed) @ pair.partner
        system = slopes.T @ sparse.diags(np.repeat(weight, 3)) @ slopes
        self._solver = splu(
            (system + sparse.diags(placed + still + _LOOSE)).tocsc(),
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
            right = self._gathered @ self._read(columns) + self._placed @ columns
            solved = self._solver.solve(right)
            shapes.append(solved.reshape(len(solved), len(run), 3).transpose(1, 0, 2))
        return np.concatenate(shapes)


class GradientReader:
    """Gradients of the source, laid on the target, at the middles of the target's triangles."""

    def __init__(self, source: Skin, target: Skin, pair: Correspondence) -> None:
        count = len(pair.warped)
        self._slopes, areas = gradient(pair.warped, source.triangles)
        self._at_vertices = _mean(_around(source.triangles, areas, count))
        beside = _around(source.triangles, np.ones_like(areas), count)
        self._near = _mean(beside @ beside.T)
        third = np.full(len(target.triangles), 1.0 / 3.0)
        middles = _around(target.triangles, third, len(target.vertices)).T
        self._partner = (middles @ pair.partner).tocsr()

    def __call__(self, values: Array) -> Array:
        """(3T, C) of ``values`` (S, C), smoothed."""
        steep = (self._slopes @ values).reshape(-1, 3 * values.shape[1])
        at = self._at_vertices @ steep
        for _ in range(_ROUNDS):
            at = self._near @ at
        return np.asarray(self._partner @ at).reshape(-1, values.shape[1])


def _around(triangles: Ints, values: NDArray[np.float64], vertices: int) -> sparse.csr_matrix:
    """(V, T) ``values`` (T,) of the triangles about each vertex."""
    columns = np.repeat(np.arange(len(triangles)), 3)
    shape = (vertices, len(triangles))
    return sparse.csr_matrix((np.repeat(values, 3), (triangles.ravel(), columns)), shape)


def _mean(matrix: sparse.csr_matrix) -> sparse.csr_matrix:
    """``matrix`` with rows that sum to one."""
    total = np.asarray(matrix.sum(axis=1)).ravel()
    return sparse.diags(1.0 / np.maximum(total, 1e-12)) @ matrix
