"""Following the head by the flow of what does not move with expressions: nose and inner eyes.

The same points are sought in every frame from one anchor patch, so that they do not drift, each
from where it was last; where the anchor no longer looks like the face, from the last frame.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.head.patch import ORIGIN

Array = NDArray[np.float64]
Grey = NDArray[np.uint8]

COUNT = 48
"""Points that are followed."""
_SPACING = 8
_GRID = np.mgrid[-24:25:_SPACING, -12:61:_SPACING].reshape(2, -1).T
_GRID = _GRID[(np.abs(_GRID[:, 0]) < 12) | (_GRID[:, 1] > 36)].astype(float)
"""Where points are taken when nothing on the nose stands out, patch units."""
_ZONES = ((-32, -12, 32, 12), (-20, 12, 20, 40), (-32, 36, 32, 72))
"""Left, top, right, bottom of what is rigid: inner eyes, bridge, nose; patch units."""
_QUALITY, _APART = 0.02, 5.0

NOSE = (50, 24, 174, 180)
"""Left, top, right, bottom of the pixels of a patch in which the points are sought."""
_CORNER = ORIGIN - np.array(NOSE[:2])
_WINDOW = (17, 17)
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


def choose(anchor: Grey) -> Array:
    """(COUNT, 2) the places on a grey patch that can be found again best (Shi and Tomasi 1994)."""
    mask = np.zeros(anchor.shape, np.uint8)
    x, y = ORIGIN.astype(int).tolist()
    for left, top, right, bottom in _ZONES:
        mask[top + y : bottom + y, left + x : right + x] = 1
    found = cv2.goodFeaturesToTrack(anchor, COUNT, _QUALITY, _APART, mask=mask)
    best = np.zeros((0, 2)) if found is None else found[:, 0].astype(float) - ORIGIN
    return np.concatenate([best, _GRID])[:COUNT]


def steepness(anchor: Grey, points: Array) -> Array:
    """(G,) how steep a grey patch is round ``points`` (G, 2), on the average 1: what lies on smooth
    skin is dragged along by the light."""
    across, down = (cv2.Scharr(anchor, cv2.CV_32F, *axis) for axis in ((1, 0), (0, 1)))
    square = cv2.blur(across**2 + down**2, _WINDOW)
    x, y = np.round(points + ORIGIN).astype(int).T
    steep = np.sqrt(square[y, x].astype(float))
    return np.asarray(steep / max(float(steep.mean()), 1e-6))


def follow(reference: Grey, there: Array, before: Array, now: Grey) -> Moved | None:
    """Find the points that are at ``there`` (G, 2) in the grey patch ``reference`` and were at
    ``before`` (G, 2) in the last frame in ``now``, the part NOSE of the grey patch taken with the
    last placement.

    None where too few agree on how the head moved.
    """
    left, top, right, bottom = NOSE
    moved, seen, _ = cv2.calcOpticalFlowPyrLK(
        reference[top:bottom, left:right],
        now,
        (there + _CORNER).astype(np.float32),
        (before + _CORNER).astype(np.float32),
        winSize=_WINDOW,
        maxLevel=_LEVELS - 1,
        flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
    )
    points = np.asarray(moved, dtype=float) - _CORNER
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
    strays = ~kept | (((points - common) ** 2).sum(axis=1) > (2.0 * _TOLERANCE) ** 2)
    points[strays] = common[strays]
    return Moved(points, np.asarray(similarity))
