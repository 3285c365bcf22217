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

import math
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Floats = NDArray[np.float32]


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
            _increment(step[:3]) @ self.rotation,
            self.translation + step[3:6],
            self.weights + step[6:],
        )


def _increment(vector: Array) -> Array:
    """(3, 3) of one rotation vector (3,) (Rodrigues), without the machinery of batches: a frame
    takes a dozen steps."""
    x, y, z = vector.tolist()
    angle = math.sqrt(x * x + y * y + z * z)
    sine = math.sin(angle) / angle if angle > 1e-6 else 1.0
    cosine = (1.0 - math.cos(angle)) / angle**2 if angle > 1e-6 else 0.5
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + sine * k + cosine * (k @ k))


@dataclass(frozen=True, slots=True)
class Lens:
    """From the camera frame to pixels."""

    focal: float
    centre: tuple[float, float]
    scale: float = 1.0
    origin: tuple[float, float] = (0.0, 0.0)

    def project(self, places: Array) -> Array:
        """(..., 2) pixels of ``places`` (..., 3) in the camera frame."""
        flat = np.ascontiguousarray(places, dtype=float).reshape(-1, 3)
        pixels = np.empty((len(flat), 2))
        across, down = self.centre[0] - self.origin[0], self.centre[1] - self.origin[1]
        _project(flat, self.focal, across, down, self.scale, pixels)
        return pixels.reshape(*places.shape[:-1], 2)

    def pull_back(self, gradient: Array, places: Array) -> Array:
        """(N, 3) derivative by place of what has the derivative ``gradient`` (N, 2) by pixel."""
        ahead = self.scale * self.focal / places[:, 2]
        across, down = gradient[:, 0] * ahead, gradient[:, 1] * ahead
        along = -(across * places[:, 0] + down * places[:, 1]) / places[:, 2]
        return np.stack([across, down, along], axis=1)


class Sites:
    """N places on a face and the K shapes that move them, laid out for speed."""

    def __init__(self, neutral: Array, shapes: Array | Floats) -> None:
        """``neutral`` (N, 3) and ``shapes`` (K, N, 3), mm, head frame."""
        self.neutral = np.ascontiguousarray(neutral, dtype=float)
        self.shapes = np.ascontiguousarray(np.moveaxis(shapes, 0, 2), dtype=np.float32)
        """(N, 3, K)"""

    def __len__(self) -> int:
        return len(self.neutral)

    def fields(self) -> Array:
        """(K, N, 3) the shapes."""
        return np.moveaxis(self.shapes, 2, 0).astype(float)

    def take(self, rows: NDArray[np.intp]) -> Sites:
        """Some of the places."""
        return Sites(self.neutral[rows], self.shapes[rows].transpose(2, 0, 1))

    def seen(self, state: State) -> Array:
        """(N, 3) in the camera frame."""
        places = np.empty((len(self), 3))
        _pose(self.neutral, self.shapes, state.rotation, state.translation, state.weights, places)
        return places

    def chain(self, slope: Array, places: Array, state: State) -> Array:
        """(N, 6 + K) derivative by the unknowns of residuals, one a place, whose derivative by
        ``places`` (N, 3) in the camera frame is ``slope`` (N, 3)."""
        jacobian = np.empty((len(self), 6 + self.shapes.shape[2]))
        _chain(self.shapes, state.rotation, state.translation, places, slope, jacobian)
        return jacobian


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _project(
    places: Array, focal: float, across: float, down: float, scale: float, pixels: Array
) -> None:
    """s (f Y_xy / Y_z + c - o) into ``pixels`` (N, 2)."""
    for n in range(len(places)):
        ahead = focal / places[n, 2]
        pixels[n, 0] = scale * (ahead * places[n, 0] + across)
        pixels[n, 1] = scale * (ahead * places[n, 1] + down)


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _pose(
    neutral: Array, shapes: Floats, rotation: Array, shift: Array, weights: Array, places: Array
) -> None:
    """R (N + sum w D) + t into ``places`` (N, 3)."""
    level = weights.astype(np.float32)
    head = np.empty(3)
    for n in range(len(neutral)):
        for i in range(3):
            moved = np.float32(0.0)
            for k in range(len(level)):
                moved += level[k] * shapes[n, i, k]
            head[i] = neutral[n, i] + moved
        for i in range(3):
            row = rotation[i]
            places[n, i] = row[0] * head[0] + row[1] * head[1] + row[2] * head[2] + shift[i]


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _chain(
    shapes: Floats, rotation: Array, shift: Array, places: Array, slope: Array, jacobian: Array
) -> None:
    """(Y - t) x h, h and R' h . D into the rows of ``jacobian`` (N, 6 + K)."""
    for n in range(len(places)):
        x, y, z = places[n, 0] - shift[0], places[n, 1] - shift[1], places[n, 2] - shift[2]
        a, b, c = slope[n, 0], slope[n, 1], slope[n, 2]
        row = jacobian[n]
        row[0], row[1], row[2] = y * c - z * b, z * a - x * c, x * b - y * a
        row[3], row[4], row[5] = a, b, c
        across = rotation[0, 0] * a + rotation[1, 0] * b + rotation[2, 0] * c
        up = rotation[0, 1] * a + rotation[1, 1] * b + rotation[2, 1] * c
        out = rotation[0, 2] * a + rotation[1, 2] * b + rotation[2, 2] * c
        for k in range(shapes.shape[2]):
            row[6 + k] = across * shapes[n, 0, k] + up * shapes[n, 1, k] + out * shapes[n, 2, k]
