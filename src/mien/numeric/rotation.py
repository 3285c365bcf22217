"""Rotations in three dimensions, batched over leading axes."""

from __future__ import annotations

import numpy as np
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
    angle = np.linalg.norm(vector, axis=-1)[..., None, None]
    small = angle < 1e-6
    safe = np.where(small, 1.0, angle)
    sine = np.where(small, 1.0 - angle**2 / 6.0, np.sin(safe) / safe)
    cosine = np.where(small, 0.5 - angle**2 / 24.0, (1.0 - np.cos(safe)) / safe**2)
    k = cross_matrix(vector)
    return np.asarray(np.eye(3) + sine * k + cosine * (k @ k))


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
    trace = np.einsum("...ii->...", m)
    # Four equivalent forms; the one with the largest divisor is exact at every angle.
    off = [(2, 1), (0, 2), (1, 0)]
    anti = np.stack([m[..., i, j] - m[..., j, i] for i, j in off], -1)
    outer = m + np.swapaxes(m, -1, -2)
    square = np.concatenate(
        [
            np.concatenate([outer, anti[..., :, None]], -1),
            np.concatenate([anti[..., None, :], np.zeros((*m.shape[:-2], 1, 1))], -1),
        ],
        -2,
    )
    diagonal = np.arange(3)
    square[..., diagonal, diagonal] += (1.0 - trace)[..., None]
    square[..., 3, 3] = 1.0 + trace
    best = np.argmax(square[..., np.arange(4), np.arange(4)], axis=-1)
    chosen = np.take_along_axis(square, best[..., None, None], axis=-2)[..., 0, :]
    return np.asarray(chosen / np.linalg.norm(chosen, axis=-1, keepdims=True))


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
