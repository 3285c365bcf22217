"""A landmark track: where the detector saw its points, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.vocabulary.landmarks import (
    EYE_CORNERS,
    IRIS,
    LOWER_LID,
    RIGID,
    UPPER_LID,
    feature_points,
)


def _kept() -> tuple[int, ...]:
    chosen = dict.fromkeys(feature_points().values())
    for group in (RIGID, *EYE_CORNERS, *UPPER_LID, *LOWER_LID, IRIS):
        chosen.update(dict.fromkeys(group))
    return tuple(chosen)


KEPT = _kept()
"""The landmarks a track keeps, of the detector's 478: an hour of video must not fill the memory."""

ROW = {landmark: row for row, landmark in enumerate(KEPT)}
"""Landmark -> row of a track."""


@dataclass(frozen=True, slots=True)
class LandmarkTrack:
    """F frames of the N = len(KEPT) landmarks, as the detector gave them."""

    time: NDArray[np.float64]
    """(F,) seconds."""
    points: NDArray[np.float32]
    """(F, N, 3) x right, y down in pixels from the picture's outer corner; z in the same scale,
    smaller is nearer. Zero where ``lost``."""
    lost: NDArray[np.bool_]
    """(F,)"""
    size: tuple[int, int]
    """Width and height of the picture."""
    faces: int = 1
    """The most faces that were in view; the points are of one of them."""

    def __len__(self) -> int:
        return len(self.time)
