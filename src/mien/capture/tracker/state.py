"""What is unknown in a frame, and how a place on the face depends on it.

    symbol                          name
    X = N + sum w_k D_k             place on the face in the head frame, mm
    Y = R X + t                     the same in the camera frame (OpenCV axes)
    u = s (f Y_xy / Y_z + c - o)    its pixel in a crop of scale s whose corner lies at o

Unknowns are a left increment of R about the head's origin, t, and w: U = 6 + K. A term that knows
h = dr/dY of its residual gets its Jacobian from ``chain``:

    dr = h . dY,   dY = omega x (R X) + dt + sum dw_k R D_k
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.numeric.rotation import from_vector

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class State:
    """Pose and expression of one frame."""

    rotation: Array
    """(3, 3) camera_from_head."""
    translation: Array
    """(3,) mm, camera frame."""
    weights: Array
    """(K,)"""

    def moved(self, step: Array) -> State:
        """This state after ``step`` (6 + K,)."""
        return State(
            from_vector(step[:3]) @ self.rotation,
            self.translation + step[3:6],
            self.weights + step[6:],
        )


@dataclass(frozen=True, slots=True)
class Lens:
    """From the camera frame to pixels."""

    focal: float
    centre: tuple[float, float]
    scale: float = 1.0
    origin: tuple[float, float] = (0.0, 0.0)

    def project(self, places: Array) -> Array:
        """(..., 2) pixels of ``places`` (..., 3) in the camera frame."""
        shift = np.subtract(self.centre, self.origin)
        return np.asarray(self.scale * (self.focal * places[..., :2] / places[..., 2:] + shift))

    def pull_back(self, gradient: Array, places: Array) -> Array:
        """(N, 3) derivative by place of what has the derivative ``gradient`` (N, 2) by pixel."""
        ahead = self.scale * self.focal / places[:, 2]
        across, down = gradient[:, 0] * ahead, gradient[:, 1] * ahead
        along = -(across * places[:, 0] + down * places[:, 1]) / places[:, 2]
        return np.stack([across, down, along], axis=1)


class Sites:
    """N places on a face and the K shapes that move them, laid out for speed."""

    def __init__(self, neutral: Array, shapes: Array) -> None:
        """``neutral`` (N, 3) and ``shapes`` (K, N, 3), mm, head frame."""
        self.neutral = neutral
        self.shapes = np.ascontiguousarray(np.moveaxis(shapes, 0, 2))
        """(N, 3, K)"""

    def __len__(self) -> int:
        return len(self.neutral)

    def take(self, rows: NDArray[np.intp]) -> Sites:
        """Some of the places."""
        return Sites(self.neutral[rows], np.moveaxis(self.shapes[rows], 2, 0))

    def at(self, weights: Array) -> Array:
        """(N, 3) in the head frame."""
        return np.asarray(self.neutral + self.shapes @ weights)

    def seen(self, state: State) -> Array:
        """(N, 3) in the camera frame."""
        return np.asarray(self.at(state.weights) @ state.rotation.T + state.translation)

    def chain(self, slope: Array, places: Array, state: State) -> Array:
        """(N, 6 + K) derivative by the unknowns of residuals, one a place, whose derivative by
        ``places`` (N, 3) in the camera frame is ``slope`` (N, 3)."""
        jacobian = np.empty((len(self), 6 + self.shapes.shape[2]))
        jacobian[:, :3] = np.cross(places - state.translation, slope)
        jacobian[:, 3:6] = slope
        back = slope @ state.rotation
        np.einsum("ni,nik->nk", back, self.shapes, out=jacobian[:, 6:])
        return jacobian
