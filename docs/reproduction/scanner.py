"""A laser scanner for characters: what is seen from where it stands, dense, noisy and in its own
axes; no more is known of it than of a real scan."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.face.mesh import Mesh
from mien.numeric.loop import subdivide
from mien.numeric.normals import vertex_normals
from mien.numeric.raster import NOTHING, rasterize
from mien.numeric.rotation import from_vector
from mien.scan.parameterise import ScanPoints
from mien.view.camera import Camera

Array = NDArray[np.float64]

NOISE, PICKED = 0.05, 0.5
"""mm: of a scanned place along its normal; of a feature point that somebody placed by hand."""
_SCANNED = ("skin", "eye_left", "eye_right", "teeth_upper", "teeth_lower", "ear_left", "ear_right")
_STANDS = (-1.1, -0.55, 0.0, 0.55, 1.1)
_SIDE = 1400
TURN, SHIFT = from_vector(np.array([0.05, 0.2, -0.06])), np.array([12.0, -20.0, 40.0])


def scan(
    character: Character, key: str | None, ids: Sequence[str], density: int, seed: int = 0
) -> tuple[Mesh, ScanPoints]:
    """A scan of ``character`` holding ``key`` (None: at rest), whose triangles are Loop's of
    ``density`` steps, and its feature points ``ids``."""
    random, face = np.random.default_rng(seed), character.face
    places = face.vertices + (0.0 if key is None else character.keys[key])
    triangles = np.concatenate([p.triangles for p in face.parts if p.name in _SCANNED])
    used, triangles = np.unique(triangles, return_inverse=True)
    dense, triangles = places[used], triangles.reshape(-1, 3)
    for _ in range(density):
        step = subdivide(triangles.astype(np.intp), len(dense))
        dense, triangles = step.matrix @ dense, step.triangles
    mesh = Mesh(dense, triangles.astype(np.int32))
    mesh = mesh.compact(_seen(mesh))
    normals = vertex_normals(mesh.vertices, mesh.triangles)
    noisy = mesh.vertices + NOISE * random.standard_normal((len(normals), 1)) * normals
    picked = face.points.at(places)[face.points.index(list(ids))]
    picked = picked + PICKED * random.standard_normal(picked.shape) / 3**0.5
    return (
        Mesh(noisy @ TURN.T + SHIFT, mesh.triangles),
        ScanPoints(tuple(ids), picked @ TURN.T + SHIFT),
    )


def _seen(mesh: Mesh) -> NDArray[np.bool_]:
    """(T,) triangles that one of the scanner's stands sees, and their neighbours."""
    seen = np.zeros(len(mesh.vertices), dtype=bool)
    one_sided = np.zeros(len(mesh.triangles), dtype=bool)
    for yaw in _STANDS:
        camera = Camera(yaw=yaw, height=290.0, size=(_SIDE, _SIDE))
        ids, _ = rasterize(camera.project(mesh.vertices), mesh.triangles, one_sided, _SIDE, _SIDE)
        seen[mesh.triangles[np.unique(ids[ids != NOTHING])]] = True
    return np.asarray(seen[mesh.triangles].any(axis=1))
