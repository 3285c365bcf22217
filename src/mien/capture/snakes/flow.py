"""Following the head by the flow of what does not move with expressions: nose and inner eyes.

The same points are sought in every frame from one anchor patch, so that they do not drift, each
from where it was last; where the anchor no longer looks like the face, from the last frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.patch import ORIGIN

Array = NDArray[np.float64]
Grey = NDArray[np.uint8]

_SPACING = 8
_LEFT, _TOP, _RIGHT, _BOTTOM = -24, -12, 24, 60
"""Nose and inner eyes, patch units."""
GRID = np.mgrid[_LEFT : _RIGHT + 1 : _SPACING, _TOP : _BOTTOM + 1 : _SPACING].reshape(2, -1).T
GRID = GRID[(np.abs(GRID[:, 0]) < 12) | (GRID[:, 1] < 4) | (GRID[:, 1] > 36)].astype(float)
"""(G, 2) where the points lie on an anchor, patch units."""

_WINDOW = (21, 21)
_LEVELS = 3
_TOLERANCE = 2.0
"""Patch units by which a point may miss the common movement and still agree."""
_FEWEST = 0.35
"""Share of the points that must agree."""


@dataclass(frozen=True, slots=True)
class Moved:
    """Where the points went."""

    points: Array
    """(G, 2) patch units."""
    similarity: Array
    """(2, 3) the head's movement: places now from places before, patch units."""


def follow(reference: Grey, there: Array, before: Array, now: Grey) -> Moved | None:
    """Find the points that are at ``there`` (G, 2) in the grey patch ``reference`` and were at
    ``before`` (G, 2) in the last frame in the patch ``now``, taken with the last placement.

    None where too few agree on how the head moved.
    """
    start = (before + ORIGIN).astype(np.float32)
    moved, seen, _ = cv2.calcOpticalFlowPyrLK(
        reference,
        now,
        (there + ORIGIN).astype(np.float32),
        start.copy(),
        winSize=_WINDOW,
        maxLevel=_LEVELS - 1,
        flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
    )
    points = np.asarray(moved, dtype=float) - ORIGIN
    kept = seen[:, 0] > 0
    if kept.sum() < _FEWEST * len(points):
        return None
    similarity, agreeing = cv2.estimateAffinePartial2D(
        before[kept],
        points[kept],
        method=cv2.RANSAC,
        ransacReprojThreshold=_TOLERANCE,
        maxIters=100,
    )
    if similarity is None or agreeing.sum() < _FEWEST * len(points):
        return None
    common = before @ similarity[:, :2].T + similarity[:, 2]
    strays = np.linalg.norm(points - common, axis=1) > 2.0 * _TOLERANCE
    points[strays | ~kept] = common[strays | ~kept]
    return Moved(points, np.asarray(similarity))
