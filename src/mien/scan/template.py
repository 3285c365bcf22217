"""The generic mesh that every scan is brought to [Z] §2: what it is, and how it is refined."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from mien.face.face import Array, Face, FeaturePoints, Ints
from mien.face.mesh import Mesh
from mien.numeric.loop import subdivide
from mien.numeric.normals import vertex_normals
from mien.scan.surface import Surface

_RAYS = 64
_REACH = 60.0
"""mm: what stands farther off does not hide a place from a scanner that goes round the head."""
_OPEN = 0.35
"""Share of the sky a place must see for a scanner to see it."""


@dataclass(frozen=True, slots=True)
class Template:
    """A control mesh and the mesh it is refined to."""

    vertices: Array
    """(V, 3) control vertices at rest, mm, head frame."""
    triangles: Ints
    """(T, 3) of the control mesh."""
    points: FeaturePoints
    """On the control mesh."""
    outside: NDArray[np.bool_]
    """(W,) of the refined vertices: what a scanner can see; not the insides of mouth, nose and
    lids."""
    refinement: sparse.csr_matrix
    """(W, V) refined from control vertices."""
    refined_triangles: Ints
    """(U, 3)"""

    def given(self, ids: tuple[str, ...]) -> tuple[sparse.csr_matrix, list[int]]:
        """Those of ``ids`` that are on the mesh: a matrix (N, V) that takes control vertices to
        them, and their rows in ``ids``."""
        known = set(self.points.ids)
        rows = [row for row, name in enumerate(ids) if name in known]
        chosen = self.points.index([ids[row] for row in rows])
        place = np.repeat(np.arange(len(rows)), 3), self.points.vertices[chosen].ravel()
        shape = len(rows), len(self.vertices)
        return sparse.csr_matrix((self.points.weights[chosen].ravel(), place), shape), rows


def make_template(
    vertices: Array,
    triangles: Ints,
    points: FeaturePoints,
    levels: int = 2,
    seen: Array | None = None,
) -> Template:
    """A template of any mesh in millimetres, refined by ``levels`` Loop steps ([Z]: two).

    ``seen`` (V,): the share of the sky each vertex sees, where the mesh is not all there is.
    """
    if seen is None:
        seen = openness(vertices, triangles)
    refinement = sparse.identity(len(vertices), format="csr")
    refined = triangles
    for _ in range(levels):
        step = subdivide(refined.astype(np.intp), refinement.shape[0])
        refinement, refined = (step.matrix @ refinement).tocsr(), step.triangles.astype(np.int32)
    return Template(vertices, triangles, points, refinement @ seen > _OPEN, refinement, refined)


def face_template(face: Face, levels: int = 2) -> Template:
    """The skin of ``face``, with the feature points that lie on it."""
    skin = face.part("skin")
    on_skin = [
        row
        for row, corners in enumerate(face.points.vertices)
        if ((corners >= skin.first) & (corners < skin.last)).all()
    ]
    points = FeaturePoints(
        tuple(face.points.ids[row] for row in on_skin),
        face.points.vertices[on_skin] - np.int32(skin.first),
        face.points.weights[on_skin],
    )
    # What eyeballs and ears hide of the skin no scanner sees either.
    solid = [
        part.triangles
        for part in face.parts
        if part.material == skin.material or part.follows.startswith("eye")
    ]
    own = slice(skin.first, skin.last)
    seen = openness(face.vertices, np.concatenate(solid))[own]
    return make_template(face.vertices[own], skin.triangles - skin.first, points, levels, seen)


def openness(vertices: Array, triangles: Ints) -> Array:
    """(V,) share of the sky over each vertex that nothing hides, 0..1, weighted by the cosine."""
    surface = Surface(Mesh(vertices, triangles))
    normals = vertex_normals(vertices, triangles)
    seen, sky = np.zeros(len(vertices)), np.full(len(vertices), 1e-9)
    for direction in _sphere(_RAYS):
        cosine = normals @ direction
        up = np.flatnonzero(cosine > 0.1)
        starts = vertices[up] + 0.05 * normals[up]
        free = ~surface.hits(starts, np.tile(direction, (len(up), 1)), _REACH).met
        seen[up] += cosine[up] * free
        sky[up] += cosine[up]
    return np.asarray(seen / sky)


def _sphere(count: int) -> Array:
    """(count, 3) directions spread evenly (a golden spiral)."""
    height = 1.0 - (2.0 * np.arange(count) + 1.0) / count
    turn = np.pi * (1.0 + 5.0**0.5) * np.arange(count)
    ring = np.sqrt(1.0 - height**2)
    return np.stack([ring * np.cos(turn), height, ring * np.sin(turn)], axis=1)
