"""What the landmark networks saw, for people who want to look over their shoulder."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.capture.landmarks import POINTS
from mien.capture.track import ROW, LandmarkTrack
from mien.performance.performance import Performance
from mien.performance.trace import Trace
from mien.vocabulary.landmarks import EYE_CORNERS, LOWER_LID, UPPER_LID, feature_points

Array = NDArray[np.float64]

_SHOWN = [ROW[feature_points()[point]] for point in POINTS]
_AXIS = 40.0
"""mm."""


def trace_of(track: LandmarkTrack, performance: Performance, focal: float, frame: int) -> Trace:
    """Feature points, lids and head axes of one frame; ``focal`` in pixels."""
    if track.lost[frame]:
        return Trace(faces=track.faces, lost=True, notes=("lost",))
    places = track.points[frame, :, :2].astype(float)
    curves = {}
    for side, (upper, lower, (outer, inner)) in {
        "left": (UPPER_LID[0], LOWER_LID[0], EYE_CORNERS[0]),
        "right": (UPPER_LID[1], LOWER_LID[1], EYE_CORNERS[1]),
    }.items():
        for edge, (middle, first, last) in (("upper", upper), ("lower", lower)):
            # The tables name the middle first, then the inner and the outer third.
            rows = [ROW[i] for i in (inner, first, middle, last, outer)]
            curves[f"lid_{side}_{edge}"] = places[rows]
    tips = np.vstack([np.zeros(3), np.eye(3)]) * _AXIS
    world = tips @ performance.rotation[frame].T + performance.translation[frame]
    centre = np.array(track.size, dtype=float) / 2.0
    axes = world[:, :2] * np.array([1.0, -1.0]) / -world[:, 2:] * focal + centre
    return Trace(curves=curves, points=places[_SHOWN], axes=axes, faces=track.faces)
