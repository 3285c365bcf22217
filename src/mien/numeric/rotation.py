"""Rotations in three dimensions, batched over leading axes."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]


def cross_matrix(vector: Array) -> Array:
    """(..., 3, 3) such that ``cross_matrix(a) @ b`` is ``a x b``."""
    x, y, z = np.moveaxis(np.asarray(vector, dtype=float), -1, 0)
    zero = np.zeros_like(x)
    rows = [[zero, -z, y], [z, zero, -x], [-y, x, zero]]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def from_vector(vector: Array) -> Array:
    """Rotation matrices (..., 3, 3) of rotation vectors (..., 3) in radians (Rodrigues)."""
    vector = np.asarray(vector, dtype=float)
    return rodrigues(np.ascontiguousarray(vector).reshape(-1, 3)).reshape(*vector.shape, 3)


@njit(cache=True, nogil=True)
def rodrigues(vectors: Array) -> Array:
    """(N, 3, 3) of (N, 3). Faces turn a few times a frame, one at a time: a loop costs a tenth of
    what many small array operations would."""
    matrices = np.empty((len(vectors), 3, 3))
    for n in range(len(vectors)):
        x, y, z = vectors[n]
        square = x * x + y * y + z * z
        angle = np.sqrt(square)
        if angle < 1e-6:
            sine, cosine = 1.0 - square / 6.0, 0.5 - square / 24.0
        else:
            sine, cosine = np.sin(angle) / angle, (1.0 - np.cos(angle)) / square
        for i in range(3):
            for j in range(3):
                matrices[n, i, j] = cosine * vectors[n, i] * vectors[n, j]
            matrices[n, i, i] += 1.0 - cosine * square
        matrices[n, 0, 1] -= sine * z
        matrices[n, 1, 0] += sine * z
        matrices[n, 0, 2] += sine * y
        matrices[n, 2, 0] -= sine * y
        matrices[n, 1, 2] -= sine * x
        matrices[n, 2, 1] += sine * x
    return matrices


def to_vector(rotation: Array) -> Array:
    """Rotation vectors (..., 3) of matrices (..., 3, 3), angles 0 to pi."""
    quaternion = to_quaternion(rotation)
    xyz, w = quaternion[..., :3], quaternion[..., 3:]
    xyz, w = np.where(w < 0, -xyz, xyz), np.abs(w)
    sine = np.linalg.norm(xyz, axis=-1, keepdims=True)
    small = sine < 1e-9
    ratio = np.where(small, 2.0, 2.0 * np.arctan2(sine, w) / np.where(small, 1.0, sine))
    return np.asarray(ratio * xyz)


def to_quaternion(rotation: Array) -> Array:
    """Unit quaternions (..., 4) in glTF's order x, y, z, w, of matrices (..., 3, 3)."""
    m = np.asarray(rotation, dtype=float)
    return _quaternions(np.ascontiguousarray(m).reshape(-1, 3, 3)).reshape(*m.shape[:-2], 4)


@njit(cache=True, nogil=True)
def _quaternions(matrices: Array) -> Array:
    """(N, 4) of (N, 3, 3). Of four equivalent forms the one with the largest divisor, which is
    exact at every angle."""
    found = np.empty((len(matrices), 4))
    for n in range(len(matrices)):
        m = matrices[n]
        trace = m[0, 0] + m[1, 1] + m[2, 2]
        best, largest = 3, 1.0 + trace
        for i in range(3):
            if 1.0 - trace + 2.0 * m[i, i] > largest:
                best, largest = i, 1.0 - trace + 2.0 * m[i, i]
        if best == 3:
            found[n, 0] = m[2, 1] - m[1, 2]
            found[n, 1] = m[0, 2] - m[2, 0]
            found[n, 2] = m[1, 0] - m[0, 1]
            found[n, 3] = largest
        else:
            j, k = (best + 1) % 3, (best + 2) % 3
            found[n, best] = largest
            found[n, j] = m[best, j] + m[j, best]
            found[n, k] = m[best, k] + m[k, best]
            found[n, 3] = m[k, j] - m[j, k]
        found[n] /= np.sqrt((found[n] ** 2).sum())
    return found


def from_quaternion(quaternion: Array) -> Array:
    """Rotation matrices (..., 3, 3) of quaternions (..., 4) x, y, z, w, of any length but 0."""
    q = np.asarray(quaternion, dtype=float)
    q = q / np.linalg.norm(q, axis=-1, keepdims=True)
    xyz, w = q[..., :3], q[..., 3, None, None]
    k = cross_matrix(xyz)
    return np.asarray(np.eye(3) + 2.0 * (w * k + k @ k))


def from_gaze(gaze: Array) -> Array:
    """Rotations (..., 3, 3) of (yaw, pitch): yaw about +y (to the subject's left), then pitch
    about the turned -x (up)."""
    yaw, pitch = np.moveaxis(np.asarray(gaze, dtype=float), -1, 0)
    zero = np.zeros_like(yaw)
    turn = from_vector(np.stack([zero, yaw, zero], -1))
    tilt = from_vector(np.stack([-pitch, zero, zero], -1))
    return turn @ tilt


def angle_between(first: Array, second: Array) -> Array:
    """Angle (...) in radians of the rotation that takes ``first`` to ``second``."""
    return np.asarray(np.linalg.norm(to_vector(np.swapaxes(first, -1, -2) @ second), axis=-1))
