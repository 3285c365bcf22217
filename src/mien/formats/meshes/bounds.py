"""What every reader of scans holds its file to."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError
from mien.face.face import Array
from mien.face.mesh import Mesh

MAX_BYTES = 1 << 30
_FARTHEST = 1e7
"""Coordinates beyond are damage: single precision has no millimetres left there."""


def triangulated(
    path: Path, groups: Sequence[tuple[NDArray[Any], NDArray[Any]]]
) -> NDArray[np.int64]:
    """(T, 3) fans of polygons, in their order: ``groups`` of rows (K,) and corners (K, n)."""
    rows, fans = [np.zeros(0, np.int64)], [np.zeros((0, 3), np.int64)]
    for row, corners in groups:
        # What is no index becomes one that no mesh has.
        safe = np.where(np.isfinite(corners), corners, -1) if corners.dtype.kind == "f" else corners
        polygon = safe.astype(np.int64)
        if polygon.shape[1] < 3:
            raise FormatError(f"{path}: a face of {polygon.shape[1]} corners; export it again")
        for k in range(1, polygon.shape[1] - 1):
            rows.append(row)
            fans.append(polygon[:, [0, k, k + 1]])
    order = np.argsort(np.concatenate(rows), kind="stable")
    return np.concatenate(fans)[order]


def sound_mesh(
    path: Path,
    vertices: Array,
    triangles: NDArray[np.int64],
    colours: Array | None,
    unit: str = "",
) -> Mesh:
    """A Mesh of what was read. Triangles at vertices that are nowhere (scanners write NaN for what
    they did not see) and triangles with a corner twice are left out. Raises FormatError where
    nothing remains or where a face names a vertex that is not there."""
    if len(triangles) and not 0 <= triangles.min() <= triangles.max() < len(vertices):
        raise FormatError(
            f"{path}: a face names a vertex that is not among the {len(vertices)}; export it again"
        )
    known = np.asarray((np.abs(vertices) < _FARTHEST).all(axis=1))
    a, b, c = triangles.T
    keep = known[triangles].all(axis=1) & (a != b) & (b != c) & (c != a)
    if not keep.any():
        raise FormatError(f"{path}: not one triangle is whole; export it again")
    return Mesh(vertices, triangles.astype(np.int32), colours, unit).compact(keep)


def linear_colours(screen: Array) -> Array:
    """Linear RGB of what a screen shows (sRGB), both 0..1; what is no number is grey."""
    value = np.clip(np.where(np.isfinite(screen), screen, 0.5), 0.0, 1.0)
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
