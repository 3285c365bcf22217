"""Where a picture is taken from."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Camera:
    """A camera that looks at a face.

    ``yaw`` and ``pitch`` in radians say where it stands: positive yaw on the subject's left,
    positive pitch above.
    """

    yaw: float = 0.0
    pitch: float = 0.0
    height: float = 300.0
    """mm that fill the picture from top to bottom at ``centre``."""
    centre: tuple[float, float, float] = (0.0, -12.0, -55.0)
    """Point looked at, mm in the world."""
    size: tuple[int, int] = (512, 512)
    """Width and height of the picture, pixels."""
    distance: float = 1100.0
    """mm from ``centre``."""

    def axes(self) -> Array:
        """(3, 3) camera_from_world: rows are right, up and towards the camera."""
        toward = np.array(
            [
                np.sin(self.yaw) * np.cos(self.pitch),
                np.sin(self.pitch),
                np.cos(self.yaw) * np.cos(self.pitch),
            ]
        )
        return look_axes(toward)

    def project(self, vertices: Array) -> NDArray[np.float32]:
        """(V, 3) of ``vertices`` (V, 3): x right and y down in pixels, and nearness, which is 1
        at ``centre`` and inversely proportional to the distance along the view."""
        width, height = self.size
        seen = (vertices - np.asarray(self.centre)) @ self.axes().T
        # What is level with the camera or behind it goes far away instead of wrapping round.
        nearness = self.distance / np.maximum(self.distance - seen[:, 2], 1e-3 * self.distance)
        scale = nearness * (height / self.height)
        screen = np.empty(vertices.shape, dtype=np.float32)
        screen[:, 0] = 0.5 * width + seen[:, 0] * scale
        screen[:, 1] = 0.5 * height - seen[:, 1] * scale
        screen[:, 2] = nearness
        return screen

    def rays(self) -> Array:
        """(3, 3) such that x rays[0] + y rays[1] + rays[2] points from what is seen at pixel
        (x, y) towards the camera."""
        width, height = self.size
        right, up, toward = self.axes()
        mm = self.height / height
        return np.stack(
            [
                -mm * right,
                mm * up,
                0.5 * width * mm * right - 0.5 * height * mm * up + self.distance * toward,
            ]
        )


def look_axes(toward: Array) -> Array:
    """(3, 3) rows right, up and ``toward``, with up as near +y as can be."""
    toward = toward / np.linalg.norm(toward)
    right = np.cross([0.0, 1.0, 0.0], toward)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(toward, right), toward])
