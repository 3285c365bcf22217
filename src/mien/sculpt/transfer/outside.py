"""What of a skin is seen from outside: not the mouth's bag, nor sockets, nor the back of a lid."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array, Ints
from mien.numeric.raster import rasterize

_VIEWS = tuple((yaw, pitch) for yaw in (-1.0, -0.5, 0.0, 0.5, 1.0) for pitch in (-0.5, 0.1, 0.5))
"""Yaw and pitch, radians, from which a face is looked at."""
_SIZE = 400
"""Samples across the picture of each view."""


def outside(vertices: Array, triangles: Ints) -> NDArray[np.bool_]:
    """(V,) whether any triangle at a vertex is seen from about the front, at its outer side."""
    used = vertices[np.unique(triangles)]
    middle = (used.min(axis=0) + used.max(axis=0)) / 2.0
    reach = float(np.linalg.norm(used - middle, axis=1).max())
    seen = np.zeros(len(triangles), dtype=bool)
    one_sided = np.zeros(len(triangles), dtype=bool)
    for yaw, pitch in _VIEWS:
        toward = np.array([np.sin(yaw) * np.cos(pitch), np.sin(pitch), np.cos(yaw) * np.cos(pitch)])
        right = np.array([np.cos(yaw), 0.0, -np.sin(yaw)])
        turned = (vertices - middle) @ np.stack([right, np.cross(toward, right), toward]).T
        screen = (turned / reach * [1.0, -1.0, 1.0] + [1.0, 1.0, 2.0]) * [
            _SIZE / 2,
            _SIZE / 2,
            1.0,
        ]
        ids, _ = rasterize(screen.astype(np.float32), triangles, one_sided, _SIZE, _SIZE)
        seen[ids[ids >= 0]] = True
    found = np.zeros(len(vertices), dtype=bool)
    found[triangles[seen]] = True
    return found
