"""Pictures of a face, drawn in software: no graphics card, no display, wheels alone."""

from __future__ import annotations

import threading
from functools import cache

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array, Face, Part
from mien.numeric.normals import vertex_normals
from mien.numeric.raster import NOTHING, fill, rasterize
from mien.view import shading
from mien.view.camera import Camera, look_axes

Picture = NDArray[np.uint8]
Floats = NDArray[np.float32]

_thread = threading.local()
_SHADOW_SIZE = 512
_SHORT_RIM = 0.03
"""A part whose rim is a smaller share of its edges hides its own inside (a head open at the neck,
a cap of hair on a skull): its back need not be drawn."""
_TOP, _BOTTOM = (0.60, 0.67, 0.75), (0.26, 0.32, 0.39)
"""Linear colours of the background."""


class Renderer:
    """Draws one face in any pose. Threads may share it."""

    def __init__(self, face: Face) -> None:
        self.face = face
        self._triangles = np.ascontiguousarray(face.triangles, dtype=np.int32)
        names = list(face.materials)
        self._material_of = _per_triangle(face, [names.index(p.material) for p in face.parts])
        closed = [_hides_its_inside(face, part) for part in face.parts]
        self._two_sided = ~_per_triangle(face, closed).astype(bool)
        self._materials = np.array(
            [
                [max(0.08, m.roughness), 0.1 * m.specular, m.subsurface, m.emission]
                for m in face.materials.values()
            ],
            dtype=np.float32,
        )
        casts = np.array([m.casts_shadow for m in face.materials.values()])[self._material_of]
        self._casters = np.ascontiguousarray(self._triangles[casts])
        self._casters_two_sided = self._two_sided[casts]
        # What does not change with the pose is laid out once.
        self._vertex = np.zeros((len(face.vertices), shading.VERTEX_COLUMNS), dtype=np.float32)
        self._vertex[:, shading.ALBEDO : shading.ALBEDO + 3] = face.colours
        self._vertex[:, shading.OPENNESS : shading.OPENNESS + 3] = _coloured_openness(face)
        self._tone = shading.tone_table()

    def render(self, vertices: Array, camera: Camera) -> Picture:
        """Picture (H, W, 3) uint8 sRGB of the face with its ``vertices`` (V, 3) posed.

        Raises ValueError when a vertex is nowhere.
        """
        if not np.isfinite(vertices).all():
            raise ValueError("a vertex is not a number")
        width, height = camera.size
        screen = camera.project(vertices)
        screen[:, :2] *= 2.0
        ids, nearness = _canvas(2 * width, 2 * height)
        fill(screen, self._triangles, self._two_sided, ids, nearness)
        lights = shading.DIRECTIONS @ camera.axes()
        shadow, cells = self._shadow(vertices, lights[0])
        vertex = self._vertex.copy()
        vertex[:, shading.SCREEN : shading.SCREEN + 3] = screen
        vertex[:, shading.SHADOW : shading.SHADOW + 3] = cells
        normals = vertex_normals(vertices, self._triangles)
        vertex[:, shading.NORMAL : shading.NORMAL + 3] = normals
        picture = _background(width, height).copy()
        shading.shade(
            ids,
            nearness,
            self._triangles,
            self._material_of,
            self._materials,
            vertex,
            (camera.rays() * [[0.5], [0.5], [1.0]]).astype(np.float32),
            lights.astype(np.float32),
            shadow,
            camera.distance,
            self._tone,
            picture,
        )
        return (picture + np.float32(0.5)).astype(np.uint8).reshape(height, width, 3)

    def _shadow(self, vertices: Array, toward: Array) -> tuple[Floats, Floats]:
        """Depth map (S, S) as seen from the key light, and the places (V, 3) of the vertices on
        it: column and row in its cells, mm towards the light."""
        axes = look_axes(toward)
        seen = vertices @ axes.T
        low, high = seen.min(axis=0), seen.max(axis=0)
        scale = (_SHADOW_SIZE - 8.0) / max(high[0] - low[0], high[1] - low[1])
        # Rows run down like those of a picture. Depths start at 1, for the rasteriser sees
        # nothing at zero.
        factor = np.array([scale, -scale, 1.0])
        offset = np.array([4.0, 4.0, 1.0]) - np.array([low[0], high[1], low[2]]) * factor
        cells = np.asarray(seen * factor + offset, dtype=np.float32)
        _, depth = rasterize(
            cells, self._casters, self._casters_two_sided, _SHADOW_SIZE, _SHADOW_SIZE
        )
        return depth, cells


def _per_triangle(face: Face, of_parts: list[int] | list[bool]) -> NDArray[np.int32]:
    """(T,) the value of each triangle's part."""
    counts = [len(part.triangles) for part in face.parts]
    return np.repeat(np.array(of_parts, dtype=np.int32), counts)


def _hides_its_inside(face: Face, part: Part) -> bool:
    """Whether a part is as good as closed, and its triangles are seen from outside."""
    triangles = part.triangles.astype(np.int64)
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    size = len(face.vertices)
    there, back = edges @ [size, 1], edges @ [1, size]
    rim = np.count_nonzero(~np.isin(back, there))
    corners = face.vertices[triangles] - face.vertices[part.first : part.last].mean(axis=0)
    volume = np.einsum("ti,ti->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2]))
    return bool(rim < _SHORT_RIM * 0.5 * len(edges) and volume > 0.0)


def _coloured_openness(face: Face) -> Array:
    """(V, 3) of ambient light: on skin, what is dim is redder, for light seeps through."""
    subsurface = np.zeros((len(face.vertices), 1))
    for part in face.parts:
        subsurface[part.first : part.last] = face.materials[part.material].subsurface
    exponent = 1.15 - subsurface * np.array([0.35, 0.1, 0.0])
    return np.asarray(face.occlusion[:, None] ** exponent)


def _canvas(width: int, height: int) -> tuple[NDArray[np.int32], Floats]:
    """Cleared ids and nearness (height, width), which are this thread's until it asks again:
    fresh memory for every picture costs a fifth of its time."""
    held: tuple[NDArray[np.int32], Floats] | None = getattr(_thread, "canvas", None)
    if held is None or held[0].shape != (height, width):
        held = np.empty((height, width), np.int32), np.empty((height, width), np.float32)
        _thread.canvas = held
    held[0].fill(NOTHING)
    held[1].fill(0.0)
    return held


@cache
def _background(width: int, height: int) -> Floats:
    """(H * W, 3) screen values 0..255 of a calm backdrop, darker below and at the corners."""
    y = np.linspace(0.0, 1.0, height)[:, None, None]
    x = np.linspace(-1.0, 1.0, width)[None, :, None]
    light = np.array(_TOP) * (1.0 - y) + np.array(_BOTTOM) * y
    vignette = 1.06 - 0.22 * (x**2 + (2.0 * y - 1.0) ** 2)
    return np.asarray(255.0 * shading.encode_srgb(light * vignette), np.float32).reshape(-1, 3)
