"""The skin of a face as one surface.

Files split vertices along the seams of a texture: what is one place becomes two that nothing holds
together, and a face made of them tears. Here such vertices are one again.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from mien.face.face import Array, Face, Ints
from mien.numeric.normals import vertex_normals

SKIN = "skin"
"""The part that deforms."""
_ALIKE = 1e-3
"""mm between vertices that are one ..."""
_FACING = 0.2
"""... if the cosine of their normals is at least this: closed lips touch and yet are two."""


@dataclass(frozen=True, slots=True)
class Skin:
    """Welded vertices and the triangles among them."""

    vertices: Array
    """(N, 3) mm in the head frame."""
    triangles: Ints
    """(T, 3) without those that welding made into lines."""
    row: NDArray[np.intp]
    """(V,) the welded vertex of each vertex of the part."""
    first: int
    """The part's first vertex in the face."""

    def spread(self, values: Array) -> Array:
        """(..., V, 3) of the part's own vertices, from values (..., N, 3)."""
        return np.asarray(values[..., self.row, :])

    def gather(self, values: Array) -> Array:
        """(..., N, 3) from values (..., F, 3) of all the face's vertices."""
        _, kept = np.unique(self.row, return_index=True)
        return np.asarray(values[..., self.first + kept, :], dtype=float)


def skin_of(face: Face) -> Skin:
    """The welded skin of ``face``. Raises KeyError where it has none."""
    part = face.part(SKIN)
    places = face.vertices[part.first : part.last]
    triangles = (part.triangles - part.first).astype(np.int32)
    normals = vertex_normals(places, triangles)
    parent = np.arange(len(places))
    pairs = cKDTree(places).query_pairs(_ALIKE, output_type="ndarray")
    alike = (normals[pairs[:, 0]] * normals[pairs[:, 1]]).sum(axis=1) > _FACING
    for low, high in np.sort(pairs[alike], axis=1):
        a, b = _root(parent, low), _root(parent, high)
        parent[max(a, b)] = min(a, b)
    roots = np.array([_root(parent, v) for v in range(len(places))])
    kept, row = np.unique(roots, return_inverse=True)
    welded = row[triangles]
    whole = (welded != np.roll(welded, 1, axis=1)).all(axis=1)
    return Skin(places[kept], welded[whole].astype(np.int32), row.ravel(), part.first)


def _root(parent: NDArray[np.intp], vertex: int) -> int:
    while parent[vertex] != vertex:
        vertex = int(parent[vertex])
    return vertex
