"""The skin of a face as one surface.

Files split vertices along the seams of a texture: what is one place becomes two that nothing holds
together, and a face made of them tears. Here such vertices are one again. The skin is what carries
the feature points, whatever the parts are called.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from mien.face.face import Array, Face, Ints, Part
from mien.numeric.normals import vertex_normals

Index = NDArray[np.intp]

_ELSEWHERE = frozenset({"3.5", "3.6", "7.1", "9.8", "9.9", "9.10", "9.11"})
_GROUPS_ELSEWHERE = frozenset({"6", "10", "11"})
"""Pupils, neck and teeth; tongue, ears and hair line: not on the skin of the face, or not at a
place that another kind of head shares."""
_SITS_ON = ("lash", "hair", "beard", "brows")
"""In the name of a part: it sits on skin and is none, even where it is welded to it."""
_ALIKE = 1e-3
"""mm between vertices that are one ..."""
_FACING = 0.2
"""... if the cosine of their normals is at least this: closed lips touch and yet are two."""
_ENOUGH = 0.1
"""Share of the feature points that makes a connected piece part of the skin."""


@dataclass(frozen=True, slots=True)
class Skin:
    """Welded vertices and the triangles among them."""

    vertices: Array
    """(N, 3) mm in the head frame."""
    triangles: Ints
    """(T, 3) without those that welding made into lines."""
    rows: Index
    """(M,) the face's vertices that are skin."""
    welded: Index
    """(M,) the vertex of this skin that each of them is."""

    def spread(self, values: Array, count: int) -> Array:
        """(..., count, 3) at all of a face's vertices, from values (..., N, 3); 0 off the skin."""
        whole = np.zeros((*values.shape[:-2], count, values.shape[-1]), values.dtype)
        whole[..., self.rows, :] = values[..., self.welded, :]
        return whole

    def gather(self, values: NDArray[np.floating[Any]]) -> Array:
        """(..., N, 3) from values (..., V, 3) at all of a face's vertices."""
        _, kept = np.unique(self.welded, return_index=True)
        return np.asarray(values[..., self.rows[kept], :], dtype=float)

    def areas(self) -> Array:
        """(N,) mm² about each vertex."""
        a, b, c = (self.vertices[self.triangles[:, k]] for k in range(3))
        third = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 6.0
        each = np.bincount(self.triangles.ravel(), np.repeat(third, 3), len(self.vertices))
        return np.asarray(each, dtype=float)


def on_skin(fdp: str) -> bool:
    """Whether a feature point lies on the skin of the face."""
    return fdp not in _ELSEWHERE and fdp.partition(".")[0] not in _GROUPS_ELSEWHERE


def skin_of(face: Face) -> Skin:
    """The skin of ``face``. Raises ValueError where no feature point is on any part."""
    triangles = np.concatenate([p.triangles for p in face.parts if _may_be_skin(p)])
    root = _weld(face.vertices, triangles.astype(np.int32))
    piece = _pieces(root[triangles], len(face.vertices))
    points = [k for k, fdp in enumerate(face.points.ids) if on_skin(fdp)]
    if not points:
        raise ValueError("no feature point on the skin")
    at = piece[root[face.points.vertices[points, 0]]]
    held = np.bincount(at, minlength=piece.max() + 1)
    skin = held >= max(1.0, _ENOUGH * len(points))
    own = root[triangles][skin[piece[root[triangles[:, 0]]]]]
    whole = (own != np.roll(own, 1, axis=1)).all(axis=1)
    used, local = np.unique(own[whole], return_inverse=True)
    rows = np.flatnonzero(np.isin(root, used))
    return Skin(
        face.vertices[used],
        local.reshape(-1, 3).astype(np.int32),
        rows,
        np.searchsorted(used, root[rows]),
    )


def _may_be_skin(part: Part) -> bool:
    name = part.name.lower()
    return part.follows == "head" and not any(word in name for word in _SITS_ON)


def _weld(vertices: Array, triangles: Ints) -> Index:
    """(V,) the first of the vertices that each is one with."""
    normals = vertex_normals(vertices, triangles)
    pairs = cKDTree(vertices).query_pairs(_ALIKE, output_type="ndarray")
    alike = pairs[(normals[pairs[:, 0]] * normals[pairs[:, 1]]).sum(axis=1) > _FACING]
    label = _joined(alike[:, 0], alike[:, 1], len(vertices))
    _, first = np.unique(label, return_index=True)
    return np.asarray(first[label])


def _pieces(triangles: Index, count: int) -> Index:
    """(V,) number of the connected piece of each vertex."""
    return _joined(triangles[:, :2].ravel(), triangles[:, 1:].ravel(), count)


def _joined(here: Index, there: Index, count: int) -> Index:
    edges = sparse.coo_matrix((np.ones(len(here)), (here, there)), (count, count))
    return np.asarray(connected_components(edges, directed=False)[1])


def pieces_beside(face: Face, skin: Skin) -> list[Index]:
    """Vertices of each connected piece that the head carries and that is not skin."""
    triangles = np.concatenate([p.triangles for p in face.parts if p.follows == "head"])
    root = _weld(face.vertices, triangles.astype(np.int32))
    free = np.ones(len(face.vertices), dtype=bool)
    free[skin.rows] = False
    for part in face.parts:
        free[part.first : part.last] &= part.follows == "head"
    beside = triangles[free[triangles].all(axis=1)]
    piece = _pieces(root[beside], len(face.vertices))[root]
    rows = np.flatnonzero(free)
    order = np.argsort(piece[rows], kind="stable")
    ends = np.flatnonzero(np.diff(piece[rows][order])) + 1
    return [run for run in np.split(rows[order], ends) if len(run)]
