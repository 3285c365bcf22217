"""Where lids end: the edge of what is seen of an eyeball from the front."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array, Ints
from mien.numeric.raster import rasterize
from mien.rig.components import Ball

_SIDE = 160
"""Pixels across an eye and half as much again."""
_MIDDLE = 0.2
"""Part of the opening's width, about its middle, in which its height is read."""
_NEAR = 0.12
"""Widths of the eye about the edge within which lies its foremost vertex."""
_DEPTH = 0.5
"""How far a vertex behind the margin counts, against one beside it."""


def margins(
    vertices: Array, triangles: Ints, skin: NDArray[np.intp], ball: Ball, width: float
) -> tuple[Array, Array] | None:
    """Places (3,) of the upper and the lower lid's margin, vertices among ``skin``, of an eye
    about ``width`` wide with ``ball`` in it; None where the ball is not seen. Upright, facing
    +z."""
    corner = ball.centre[:2] + 0.75 * width * np.array([-1.0, 1.0])
    pixel = 1.5 * width / _SIDE
    screen = np.empty((len(vertices), 3), np.float32)
    screen[:, :2] = (vertices[:, :2] - corner) / [pixel, -pixel]
    screen[:, 2] = 1.0 + (vertices[:, 2] - vertices[:, 2].min()) / width
    counts = ball.vertices.copy()
    counts[skin] = True
    # Lashes hang before the eye and are no margin.
    drawn = triangles[counts[triangles[:, 0]]]
    ids, _ = rasterize(screen, drawn, np.ones(len(drawn), bool), _SIDE, _SIDE)
    seen = (ids >= 0) & ball.vertices[drawn[ids, 0]]
    rows, columns = np.nonzero(seen)
    if len(rows) < _SIDE:
        return None
    middle, spread = np.median(columns), _MIDDLE * np.ptp(columns)
    near = np.abs(columns - middle) <= max(spread, 1.0)
    across = corner[0] + pixel * (middle + 0.5)
    found = []
    for row in (np.percentile(rows[near], 2), np.percentile(rows[near], 98)):
        place = np.array([across, corner[1] - pixel * (row + 0.5)])
        aside = np.linalg.norm(vertices[skin, :2] - place, axis=1)
        depth = vertices[skin, 2]
        # The edge that is seen is the foremost: behind it the lid runs back along the ball.
        front = depth[aside < max(_NEAR * width, float(aside.min()) * 1.01)].max()
        cost = np.hypot(aside, _DEPTH * np.minimum(depth - front, 0.0))
        found.append(vertices[skin[cost.argmin()]])
    return found[0], found[1]
