"""Ambient occlusion: how much of the sky each vertex sees, by depth tests from many sides."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Index = NDArray[np.intp]

_DIRECTIONS = 72
_PIXELS = 320
_BORDER = 0.02
_BIAS = 1.2
"""mm a surface may lie behind itself and still count as seen."""


def sky_seen(vertices: Array, triangles: Index, normals: Array) -> Array:
    """(V,) 0 buried .. 1 open; light from above counts a little more."""
    seen, total = np.zeros(len(vertices)), np.zeros(len(vertices))
    faces = np.ascontiguousarray(triangles, dtype=np.int64)
    for direction in _even_directions(_DIRECTIONS):
        facing = normals @ direction
        turn = _looking_along(direction)
        turned = vertices @ turn.T
        low, high = turned[:, :2].min(axis=0), turned[:, :2].max(axis=0)
        scale = _PIXELS * (1 - 2 * _BORDER) / (high - low).max()
        screen = np.column_stack([(turned[:, :2] - low) * scale + _PIXELS * _BORDER, turned[:, 2]])
        nearest = _depths(screen, faces, _PIXELS)
        column, row = np.clip(screen[:, :2].astype(int), 0, _PIXELS - 1).T
        visible = turned[:, 2] + _BIAS + 1.2 * (1 - facing) / scale >= nearest[row, column]
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


@njit(cache=True)
def _depths(screen: Array, triangles: NDArray[np.int64], size: int) -> Array:
    """(size, size) nearest depth (largest z) at each pixel."""
    nearest = np.full((size, size), -1e9)
    for number in range(len(triangles)):
        a, b, c = (
            screen[triangles[number, 0]],
            screen[triangles[number, 1]],
            screen[triangles[number, 2]],
        )
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if abs(area) < 1e-12:
            continue
        left = max(0, int(np.floor(min(a[0], b[0], c[0]))))
        right = min(size - 1, int(np.ceil(max(a[0], b[0], c[0]))))
        bottom = max(0, int(np.floor(min(a[1], b[1], c[1]))))
        top = min(size - 1, int(np.ceil(max(a[1], b[1], c[1]))))
        for row in range(bottom, top + 1):
            for column in range(left, right + 1):
                x, y = column + 0.5, row + 0.5
                v = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
                w = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
                if v < -1e-6 or w < -1e-6 or v + w > 1 + 1e-6:
                    continue
                depth = a[2] + v * (b[2] - a[2]) + w * (c[2] - a[2])
                if depth > nearest[row, column]:
                    nearest[row, column] = depth
    return nearest
