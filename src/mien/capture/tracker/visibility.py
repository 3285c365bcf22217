"""Which texels a posed face shows."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.capture.tracker.chart import Chart
from mien.capture.tracker.state import Lens
from mien.numeric.raster import rasterize

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

_COARSE = 0.5
"""Pixels of the depth picture for one of the crop."""
_BEHIND = 4.0
"""mm a texel may lie behind the nearest skin: the depth picture is coarse."""


def facing(chart: Chart, places: Array) -> Array:
    """(M,) cosine between the skin and the line of sight at ``places`` (M, 3) in the camera frame;
    0 at the chart's rim."""
    cosine = np.zeros(len(chart))
    _facing(chart.near, chart.inner, places, cosine)
    return cosine


def unhidden(
    places: Array, vertices: Array, triangles: NDArray[np.int32], lens: Lens, size: tuple[int, int]
) -> Bools:
    """(M,) no other skin lies before ``places`` (M, 3), and the picture (width, height) holds
    them. ``vertices`` (V, 3) of the whole face, camera frame."""
    width, height = (max(1, int(n * _COARSE)) for n in size)
    screen = np.column_stack([lens.project(vertices) * _COARSE, 1000.0 / vertices[:, 2]])
    _, nearness = rasterize(
        screen.astype(np.float32), triangles, np.zeros(len(triangles), bool), width, height
    )
    at = np.floor(lens.project(places) * _COARSE).astype(int)
    inside = ((at >= 0) & (at < (width, height))).all(axis=1)
    column, row = np.clip(at.T, 0, [[width - 1], [height - 1]])
    nearest = nearness[row, column]
    depth = 1000.0 / np.maximum(nearest, 1e-6)
    return np.asarray(inside & ((nearest == 0.0) | (places[:, 2] < depth + _BEHIND)))


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _facing(near: NDArray[np.intp], inner: Bools, places: Array, cosine: Array) -> None:
    for m in range(len(places)):
        if not inner[m]:
            continue
        left, right, above, below = near[m]
        rx, ry, rz = _between(places, left, right)
        dx, dy, dz = _between(places, above, below)
        nx, ny, nz = dy * rz - dz * ry, dz * rx - dx * rz, dx * ry - dy * rx
        x, y, z = places[m, 0], places[m, 1], places[m, 2]
        size = np.sqrt((nx * nx + ny * ny + nz * nz) * (x * x + y * y + z * z))
        cosine[m] = -(nx * x + ny * y + nz * z) / max(size, 1e-9)


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _between(places: Array, first: int, second: int) -> tuple[float, float, float]:
    return (
        places[second, 0] - places[first, 0],
        places[second, 1] - places[first, 1],
        places[second, 2] - places[first, 2],
    )


def visible_triangles(vertices: Array, triangles: NDArray[np.int32]) -> Bools:
    """(T,) triangles of ``vertices`` (V, 3), camera frame, whose outside faces the camera."""
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    return np.asarray((np.cross(b - a, c - a) * a).sum(axis=1) < 0.0)


def contour(vertices: Array, triangles: NDArray[np.int32]) -> NDArray[np.intp]:
    """(N,) vertices along the outline that a face shows, the longest closed run of edges between
    what faces the camera and what does not (or is not there)."""
    shown = triangles[visible_triangles(vertices, triangles)]
    follower = {int(a): int(b) for a, b in _rims(shown)}
    best: list[int] = []
    while follower:
        start, run = next(iter(follower)), []
        here = start
        while here in follower:
            run.append(here)
            here = follower.pop(here)
        best = max(best, [*run, here], key=len)
    return np.array(best, dtype=np.intp)


def _rims(triangles: NDArray[np.int32]) -> NDArray[np.int32]:
    """(E, 2) directed edges that one triangle alone has."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    many = int(triangles.max(initial=0)) + 1
    key = edges[:, 0].astype(np.int64) * many + edges[:, 1]
    back = edges[:, 1].astype(np.int64) * many + edges[:, 0]
    return np.asarray(edges[~np.isin(key, back)])
