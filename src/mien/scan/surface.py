"""A scan as something rays can be sent against. Nothing else imports embree."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.errors import MissingExtraError
from mien.face.face import Array
from mien.face.mesh import Mesh

NOTHING = -1


@dataclass(frozen=True, slots=True)
class Hits:
    """Where N rays met a surface first."""

    triangle: NDArray[np.int32]
    """(N,) NOTHING where a ray met none."""
    place: Array
    """(N, 3) mm; not a number where a ray met nothing."""
    distance: Array
    """(N,) mm from the ray's start; infinite where it met nothing."""

    @property
    def met(self) -> NDArray[np.bool_]:
        """(N,)"""
        return np.asarray(self.triangle != NOTHING)


class Surface:
    """A triangle mesh in millimetres, ready for rays. Both sides of a triangle are met.

    Raises MissingExtraError without embree.
    """

    def __init__(self, mesh: Mesh) -> None:
        try:
            from embreex.mesh_construction import TriangleMesh
            from embreex.rtcore_scene import EmbreeScene
        except ImportError as error:
            raise MissingExtraError("working with scans", "scan") from error
        self.mesh = mesh
        # Single precision is finest about the origin.
        self._origin = mesh.vertices.mean(axis=0)
        self._scene: Any = EmbreeScene()
        TriangleMesh(self._scene, (mesh.vertices - self._origin).astype(np.float32), mesh.triangles)
        corners = mesh.vertices[mesh.triangles]
        cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        length = np.linalg.norm(cross, axis=1, keepdims=True)
        self.normals: Array = cross / np.maximum(length, 1e-12)
        """(T, 3) unit normals; zero where a triangle has none."""

    def hits(self, origins: Array, directions: Array, limit: float = np.inf) -> Hits:
        """First meeting of rays from ``origins`` (N, 3) along unit ``directions`` (N, 3), at most
        ``limit`` mm away."""
        starts = np.ascontiguousarray(origins - self._origin, dtype=np.float32)
        along = np.ascontiguousarray(directions, dtype=np.float32)
        reach = np.full(len(starts), min(limit, 1e30), dtype=np.float32)
        found = self._scene.run(starts, along, dists=reach, output=True)
        triangle = np.asarray(found["primID"], dtype=np.int32)
        met = triangle != NOTHING
        distance = np.where(met, found["tfar"].astype(np.float64), np.inf)
        place = np.full(origins.shape, np.nan)
        place[met] = origins[met] + distance[met, None] * directions[met]
        return Hits(triangle, place, distance)
