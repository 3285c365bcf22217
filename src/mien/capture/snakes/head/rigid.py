"""What of a head keeps its form: points on the nose, the eyes' corners, and the neck it turns on.

A smooth nose tells poorly how far a head is turned. But a head sits before and above the joint it
turns on, so a face that looks aside also moves aside: the neck, taken for one point more of the
head, hardly moves in the picture. Where somebody walks, or the camera does, it moves after all, and
being an outlier counts little; its place is learnt anew while it does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.head.patch import Placement
from mien.capture.snakes.head.pose import Pose, fit_pose

Array = NDArray[np.float64]

NECK = np.array([0.0, 45.0, 150.0])
"""What a resting head turns on: x right, y down, z away; patch units."""
_NECK_WEIGHT, _NECK_KNEE = 0.6, 13.6
"""Points that it counts for, and patch units of a miss from where it counts half."""
_MEMORY = 90.0
"""Frames in which its place follows where the head's turn has it."""
_CORNER_WEIGHT = 6.0
"""Points of the nose that an eye corner counts for: far apart, they tell how the head leans."""
_KNEE = 4.0


@dataclass(frozen=True, slots=True)
class Rigid:
    """N points of a resting head, the neck last."""

    places: Array
    """(N, 3) patch units: x right, y down, z away."""
    weight: Array
    """(N,) how much each counts."""
    knee: Array
    """(N,) patch units of a miss from where it counts half as much."""

    @classmethod
    def of(cls, points: Array, weight: Array, corners: Array) -> Rigid:
        """From points of the nose (G, 3), what each counts (G,), and corners of the eyes (C, 3)."""
        others = np.repeat([_CORNER_WEIGHT, _NECK_WEIGHT], [len(corners), 1])
        return cls(
            np.concatenate([points, corners, NECK[None]]),
            np.concatenate([weight, others]),
            np.repeat([_KNEE, _NECK_KNEE], [len(points) + len(corners), 1]),
        )

    def pose(self, seen: Array, start: Pose) -> Pose:
        """The head's pose where its first points are ``seen`` (up to N, 2), from ``start`` on."""
        n = len(seen)
        return fit_pose(self.places[:n], seen, self.weight[:n], self.knee[:n], start)


def neck_of(placement: Placement, pose: Pose) -> Array:
    """(2,) where a head's neck is, pixels of the frame."""
    return placement.to_frame(pose(NECK))


def remembered(neck: Array | None, now: Array) -> Array:
    """(2,) where a neck that was believed to be at ``neck`` is believed to be after a frame in
    which the head's turn has it at ``now``."""
    return now if neck is None else np.asarray(neck + (now - neck) / _MEMORY)
