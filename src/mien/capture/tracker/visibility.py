"""Which texels a posed face shows."""

from __future__ import annotations

import numpy as np
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
    right, down = chart.slopes(places, np.arange(len(chart)))
    normal = np.cross(down, right)
    size = np.linalg.norm(normal, axis=1) * np.linalg.norm(places, axis=1)
    cosine = -(normal * places).sum(1) / np.maximum(size, 1e-9)
    return np.where(chart.inner, cosine, 0.0)


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
