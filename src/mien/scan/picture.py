"""Scans and what was made of them as pictures."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array, Face, FeaturePoints, Material, Part
from mien.face.mesh import Mesh
from mien.view.camera import Camera
from mien.view.renderer import Renderer

Picture = NDArray[np.uint8]

CLAY = np.array([0.62, 0.45, 0.36])
"""Linear RGB of a scan without colours: skin, which the detector knows."""


def mesh_face(mesh: Mesh) -> Face:
    """A mesh as the renderer takes it: one part of skin, without feature points."""
    count = len(mesh.vertices)
    nowhere = FeaturePoints((), np.zeros((0, 3), np.int32), np.zeros((0, 3)))
    return Face(
        vertices=mesh.vertices,
        parts=(Part("scan", "skin", 0, count, mesh.triangles),),
        materials={"skin": Material(roughness=0.7, specular=0.3)},
        colours=np.tile(CLAY, (count, 1)) if mesh.colours is None else mesh.colours,
        occlusion=np.ones(count),
        points=nowhere,
        pivots={},
    )


def render_mesh(mesh: Mesh, camera: Camera) -> Picture:
    """Picture (H, W, 3) of a mesh in millimetres."""
    return Renderer(mesh_face(mesh)).render(mesh.vertices, camera)


def mark(picture: Picture, camera: Camera, places: Array, size: int = 3) -> Picture:
    """``picture`` with a disc at each of ``places`` (N, 3)."""
    marked = picture.copy()
    height, width = picture.shape[:2]
    rows, columns = np.mgrid[0:height, 0:width] + 0.5
    for x, y, _ in camera.project(places):
        apart = np.hypot(columns - x, rows - y)
        marked[apart < size + 1.0] = (20, 20, 20)
        marked[apart < size] = (60, 240, 90)
    return marked
