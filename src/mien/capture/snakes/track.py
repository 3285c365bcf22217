"""What the snakes found in a take, frame by frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.points import COUNT, places
from mien.capture.snakes.stepper import Seen

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class CurveTrack:
    """F frames of the N points on the curves and the head."""

    time: Array
    """(F,) seconds."""
    points: Array
    """(F, N, 2) pixels of the frame, its first pixel's centre at (0.5, 0.5); zero where lost."""
    opening: Array
    """(F, 2) heights of the left and right eye, over the eyes' distance."""
    tongue: Array
    """(F,)"""
    lost: NDArray[np.bool_]
    """(F,)"""
    size: tuple[int, int]
    """Width and height of the picture."""

    def __len__(self) -> int:
        return len(self.time)
