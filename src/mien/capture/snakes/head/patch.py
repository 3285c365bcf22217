"""The patch: a small upright picture of the face that follows the head.

All that is measured is measured here, so that costs do not grow with the camera's picture and
every constant is in hundredths of the distance between the eyes.

    patch units       origin midway between the eyes, x right, y down, the eyes 100 apart
    pixels of patch   patch units + ORIGIN; whole numbers are pixel centres
    pixels of frame   the first pixel's centre is (0.5, 0.5)
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

WIDTH, HEIGHT = 224, 264
WHOLE = (0, 0, WIDTH, HEIGHT)
COARSE = 2
"""Patch units from one pixel to the next of the small patch, on which most is looked for."""
ORIGIN = np.array([112.0, 75.0])
EYES = np.array([[-50.0, 0.0], [50.0, 0.0]])
"""Where the eyes lie, the right one first; patch units."""


@dataclass(frozen=True, slots=True)
class Placement:
    """Where the face is in a frame: patch = scale * turn @ frame + shift, without mirroring."""

    matrix: Array
    """(2, 3) patch units from pixels of the frame."""

    @classmethod
    def at(cls, eyes: Array, rest: Array = EYES) -> Placement:
        """From the middles of the right and the left eye, ``eyes`` (2, 2) pixels of the frame,
        which come to lie at ``rest`` (2, 2) patch units."""
        across, wanted = eyes[1] - eyes[0], rest[1] - rest[0]
        length = float(across @ across)
        c = float(wanted @ across) / length
        s = float(wanted[0] * across[1] - wanted[1] * across[0]) / length
        turn = np.array([[c, s], [-s, c]])
        return cls(np.column_stack([turn, rest.mean(axis=0) - turn @ eyes.mean(axis=0)]))

    @property
    def scale(self) -> float:
        """Patch units in a pixel of the frame."""
        return float(np.hypot(*self.matrix[0, :2]))

    @property
    def roll(self) -> float:
        """Radians by which the head leans to the picture's right (clockwise)."""
        return float(np.arctan2(self.matrix[0, 1], self.matrix[0, 0]))

    def to_patch(self, places: Array) -> Array:
        """(..., 2) patch units of pixels of the frame."""
        return np.asarray(places @ self.matrix[:, :2].T + self.matrix[:, 2])

    def to_frame(self, places: Array) -> Array:
        """(..., 2) pixels of the frame of patch units."""
        turn = self.matrix[:, :2]
        return np.asarray((places - self.matrix[:, 2]) @ (turn / (turn[0] @ turn[0])))

    def moved(self, similarity: Array) -> Placement:
        """The placement whose patch units are ``similarity`` (2, 3) of this one's."""
        turn = similarity[:, :2] @ self.matrix[:, :2]
        shift = similarity[:, :2] @ self.matrix[:, 2] + similarity[:, 2]
        return Placement(np.column_stack([turn, shift]))

    def warp(self, image: Picture, part: tuple[int, int, int, int] = WHOLE) -> Picture:
        """(HEIGHT, WIDTH, 3) the patch of a frame, or its pixels ``part`` (left, top, right,
        bottom); beyond the frame its border goes on."""
        left, top, right, bottom = part
        matrix = self.matrix.copy()
        matrix[:, 2] += ORIGIN + matrix[:, :2] @ np.array([0.5, 0.5]) - np.array([left, top])
        return np.asarray(
            cv2.warpAffine(
                image,
                matrix,
                (right - left, bottom - top),
                flags=cv2.INTER_LINEAR,
                borderMode=cv2.BORDER_REPLICATE,
            )
        )


def grey_of(patch: Picture) -> Picture:
    """(H, W) the brightness of a picture (H, W, 3)."""
    return np.asarray(cv2.cvtColor(patch, cv2.COLOR_RGB2GRAY))
