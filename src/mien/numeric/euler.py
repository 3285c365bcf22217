"""Yaw, pitch and roll, for people and for formats that carry them."""

from __future__ import annotations

import numpy as np

from mien.numeric.rotation import Array, from_vector


def from_euler(angles: Array) -> Array:
    """Rotations (..., 3, 3) of (yaw, pitch, roll) (..., 3) in radians: roll about -z, then pitch
    about -x, then yaw about +y, all about fixed axes.

    For something that looks along +z with +y up, positive angles turn it to its left, up, and
    lean it to its left.
    """
    turn, tilt, lean = (
        from_vector(angles[..., i, None] * axis)
        for i, axis in enumerate(np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, -1.0]]))
    )
    return np.asarray(turn @ tilt @ lean)


def to_euler(rotation: Array) -> Array:
    """The (yaw, pitch, roll) (..., 3) of rotations (..., 3, 3), pitch within a quarter turn.

    Looking straight up or down leaves yaw and roll undecided; roll is then 0.
    """
    r = np.asarray(rotation, dtype=float)
    across = np.hypot(r[..., 1, 0], r[..., 1, 1])
    pitch = np.arctan2(r[..., 1, 2], across)
    level = across > 1e-9
    yaw = np.where(
        level,
        np.arctan2(r[..., 0, 2], r[..., 2, 2]),
        np.arctan2(-r[..., 2, 0], r[..., 0, 0]),
    )
    roll = np.where(level, np.arctan2(-r[..., 1, 0], r[..., 1, 1]), 0.0)
    return np.stack([yaw, pitch, roll], axis=-1)
