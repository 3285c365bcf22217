"""Ambient occlusion: how much of the sky each vertex sees, by depth tests from many sides."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.numeric.normals import vertex_normals
from mien.numeric.raster import rasterize

Array = NDArray[np.float64]
Ints = NDArray[np.int32]

_DIRECTIONS = 72
_PIXELS = 320
_BORDER = 0.02
_BIAS = 1.2
"""mm a surface may lie behind itself and still count as seen."""


def sky_seen(vertices: Array, triangles: Ints) -> Array:
    """(V,) 0 buried .. 1 open; light from above counts a little more."""
    normals = vertex_normals(vertices, triangles)
    both = np.ones(len(triangles), bool)
    seen, total = np.zeros(len(vertices)), np.zeros(len(vertices))
    for direction in _even_directions(_DIRECTIONS):
        facing = normals @ direction
        turned = vertices @ _looking_along(direction).T
        low, high = turned.min(axis=0), turned.max(axis=0)
        scale = _PIXELS * (1 - 2 * _BORDER) / (high - low)[:2].max()
        screen = (turned - low) * scale + _PIXELS * _BORDER
        _, nearest = rasterize(screen.astype(np.float32), triangles, both, _PIXELS, _PIXELS)
        column, row = np.clip(screen[:, :2].astype(int), 0, _PIXELS - 1).T
        behind = (nearest[row, column] - screen[:, 2]) / scale
        visible = behind <= _BIAS + 1.2 * (1 - facing) / scale
        weight = np.where(facing > 0.02, facing, 0.0) * (1 + 0.35 * direction[1])
        seen += weight * visible
        total += weight
    return np.asarray(seen / np.maximum(total, 1e-9))


def _even_directions(count: int) -> Array:
    """Fibonacci's sphere."""
    number = np.arange(count) + 0.5
    polar = np.arccos(1 - 2 * number / count)
    around = np.pi * (1 + 5**0.5) * number
    return np.stack(
        [np.cos(around) * np.sin(polar), np.cos(polar), np.sin(around) * np.sin(polar)], axis=1
    )


def _looking_along(direction: Array) -> Array:
    up = np.array([0.0, 1.0, 0.0]) if abs(direction[1]) < 0.95 else np.array([0.0, 0.0, 1.0])
    right = np.cross(up, direction)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(direction, right), direction])
