"""Where to stand to see all of a head, whatever its size and whether it has a body."""

from __future__ import annotations

import numpy as np

from mien.face.face import Face
from mien.view.camera import Camera

_HEADROOM = 2.6
"""Diameter of what counts as head, in heights of its feature points."""
_MARGIN = 1.3
"""Height of the picture, in that of the head: mouths open and heads nod."""


def framing(face: Face) -> Camera:
    """A camera in front of the head that ``face`` is part of."""
    places = face.points.at(face.vertices)
    reach = _HEADROOM * float(np.ptp(places[:, 1])) / 2.0
    near = np.linalg.norm(face.vertices - places.mean(axis=0), axis=1) < reach
    low, high = face.vertices[near].min(axis=0), face.vertices[near].max(axis=0)
    height = _MARGIN * float((high - low)[:2].max())
    x, y, z = ((low + high) / 2.0).tolist()
    return Camera(height=height, centre=(x, y, z), distance=4.0 * height)
