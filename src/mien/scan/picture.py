"""Pictures of scans: plain light on hundreds of thousands of triangles, for the detector's eyes and
the user's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw
from scipy import sparse

from mien.face.face import Array
from mien.face.mesh import Mesh
from mien.numeric.normals import vertex_normals
from mien.numeric.raster import NOTHING, rasterize
from mien.view.camera import Camera
from mien.view.shading import encode_srgb

Picture = NDArray[np.uint8]

CLAY = (0.56, 0.37, 0.28)
"""Linear RGB of a scan without colours: skin, which the detector knows."""
_BACKGROUND = (0.45, 0.50, 0.56)
_LIGHTS = ((0.3, 0.5, 0.8, 0.75), (-0.8, 0.1, 0.4, 0.25))
"""Direction in the camera's axes (right, up, towards it), and strength."""
_AMBIENT = 0.25
_SMOOTHINGS = 4
"""Rounds of averaging normals over neighbours: a scanner's noise is stubble otherwise."""
_SIDE, _ROOM = 720, 1.5
"""Pixels of a view to check points by, and how much more than the points it shows."""
_SAMPLES = 2
"""Across and down in a pixel."""


@dataclass(frozen=True, slots=True)
class Drawable:
    """A mesh made ready to be drawn from many sides."""

    mesh: Mesh
    normals: Array
    """(V, 3)"""


def drawable(mesh: Mesh) -> Drawable:
    """``mesh`` with smooth normals."""
    count = len(mesh.vertices)
    here = mesh.triangles[:, [0, 1, 2]].ravel()
    there = mesh.triangles[:, [1, 2, 0]].ravel()
    near = sparse.csr_matrix((np.ones(len(here)), (here, there)), (count, count))
    normals = vertex_normals(mesh.vertices, mesh.triangles)
    for _ in range(_SMOOTHINGS):
        normals = normals + near @ normals + near.T @ normals
        normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    return Drawable(mesh, normals)


def draw(subject: Drawable, camera: Camera) -> Picture:
    """Picture (H, W, 3) uint8 sRGB of a mesh in millimetres."""
    mesh, (width, height) = subject.mesh, camera.size
    screen = camera.project(mesh.vertices)
    screen[:, :2] *= _SAMPLES
    wide, tall = _SAMPLES * width, _SAMPLES * height
    both = np.ones(len(mesh.triangles), dtype=bool)
    ids, _ = rasterize(screen, mesh.triangles, both, wide, tall)
    rows, columns = np.nonzero(ids != NOTHING)
    corners = mesh.triangles[ids[rows, columns]]
    x, y = columns.astype(np.float64) + 0.5, rows.astype(np.float64) + 0.5
    share = _shares(screen[corners, :2].astype(float), x, y)
    normals = np.einsum("nk,nkx->nx", share, subject.normals[corners]) @ camera.axes().T
    light = np.full(len(rows), _AMBIENT)
    for *toward, strength in _LIGHTS:
        cosine = normals @ (np.array(toward) / np.linalg.norm(toward))
        light += strength * np.maximum(cosine, 0.0)
    albedo = CLAY if mesh.colours is None else np.einsum("nk,nkx->nx", share, mesh.colours[corners])
    image = np.tile(np.array(_BACKGROUND), (tall, wide, 1))
    image[rows, columns] = light[:, None] * albedo
    image = image.reshape(height, _SAMPLES, width, _SAMPLES, 3).mean(axis=(1, 3))
    return np.asarray(255.0 * encode_srgb(np.clip(image, 0.0, 1.0)) + 0.5, dtype=np.uint8)


def _shares(corners: Array, x: Array, y: Array) -> Array:
    """(N, 3) barycentric weights of (x, y) (N,) in triangles ``corners`` (N, 3, 2)."""
    (ax, ay), (bx, by), (cx, cy) = np.moveaxis(corners, 0, -1)
    area = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)
    area = np.where(np.abs(area) < 1e-12, 1.0, area)
    second = ((x - ax) * (cy - ay) - (y - ay) * (cx - ax)) / area
    third = ((bx - ax) * (y - ay) - (by - ay) * (x - ax)) / area
    share = np.clip(np.stack([1.0 - second - third, second, third], axis=1), 0.0, 1.0)
    return np.asarray(share / np.maximum(share.sum(axis=1, keepdims=True), 1e-9))


def points_picture(mesh: Mesh, ids: tuple[str, ...], places: Array) -> Picture:
    """A scan from the front and from either side with its points (N, 3), labelled."""
    subject = drawable(mesh)
    low, high = places.min(axis=0), places.max(axis=0)
    views = []
    for yaw in (-0.7, 0.0, 0.7):
        camera = Camera(
            yaw=yaw,
            height=_ROOM * float(high[1] - low[1]),
            centre=tuple(((low + high) / 2.0).tolist()),
            size=(_SIDE, _SIDE),
        )
        views.append(mark(draw(subject, camera), camera, places, ids))
    return np.hstack(views)


def mark(
    picture: Picture, camera: Camera, places: Array, labels: tuple[str, ...] | None = None
) -> Picture:
    """``picture`` with a ring and, where given, a label at each of ``places`` (N, 3)."""
    image = Image.fromarray(picture)
    pen = ImageDraw.Draw(image)
    for row, (x, y, _) in enumerate(camera.project(places)):
        pen.ellipse((x - 3, y - 3, x + 3, y + 3), outline=(20, 30, 20), fill=(70, 240, 110))
        if labels is not None:
            pen.text((x + 4, y - 10), labels[row], (255, 255, 255), stroke_width=1, stroke_fill=0)
    return np.asarray(image)
