"""Datagrams of OpenSeeFace, port 11573: 1785 little-endian bytes a face, without padding.

    double time, int32 face, float32 width, height, openness of the right and the left eye,
    uint8 success, float32 error, quaternion[4], euler[3], translation[3], confidence[68],
    points2d[68][2] pixels, points3d[70][3], features[14]

Sixty-six points of iBUG's sixty-eight (the inner corners of the mouth are left out), then the
right and the left pupil; in space also the right and the left eyeball. Written as the sender of
emilianavt/OpenSeeFace (BSD-2) writes it.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.numeric.rotation import to_quaternion

PORT = 11573
BYTES = 1785
POINTS, PLACES, FEATURES = 68, 70, 14

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class SeenFace:
    """One face as OpenSeeFace tells it. Sides are the subject's."""

    time: float
    """Seconds."""
    size: tuple[int, int]
    """Width and height of the picture, pixels."""
    openness: tuple[float, float]
    """Of the left and the right eye: 1 open, 0 shut."""
    seen: bool
    rotation: Array
    """(3, 3) camera_from_head, OpenCV's camera axes."""
    translation: Array
    """(3,) in the camera's axes, in units of the points."""
    picture: Array
    """(68, 2) pixels."""
    places: Array
    """(70, 3) in the head's own axes: +x to the picture's right for a face that looks at the
    viewer, +y up, +z towards the viewer."""
    features: Array
    """(14,) as named in FEATURE_NAMES, -1..1."""


FEATURE_NAMES = (
    "eye_l",
    "eye_r",
    "eyebrow_steepness_l",
    "eyebrow_updown_l",
    "eyebrow_quirk_l",
    "eyebrow_steepness_r",
    "eyebrow_updown_r",
    "eyebrow_quirk_r",
    "mouth_corner_updown_l",
    "mouth_corner_inout_l",
    "mouth_corner_updown_r",
    "mouth_corner_inout_r",
    "mouth_open",
    "mouth_wide",
)


def encode(face: SeenFace, number: int = 0) -> bytes:
    """The datagram of one face, the ``number``-th in the picture."""
    left, right = face.openness
    turn = to_quaternion(face.rotation)
    head = struct.pack(
        "<di4fBf", face.time, number, *map(float, face.size), right, left, face.seen, 0.0
    )
    # The sender writes points in its own axes, of which two point the other way.
    places = face.places * [1.0, -1.0, -1.0]
    numbers = [turn, _euler(face.rotation), face.translation, np.full(POINTS, float(face.seen))]
    numbers += [face.picture.ravel(), places.ravel(), face.features]
    return head + np.concatenate(numbers).astype("<f4").tobytes()


def _euler(rotation: Array) -> Array:
    """(3,) degrees about x, y and z, as OpenCV's RQ decomposition has them."""
    side = np.hypot(rotation[2, 1], rotation[2, 2])
    return np.degrees(
        [
            np.arctan2(rotation[2, 1], rotation[2, 2]),
            np.arctan2(-rotation[2, 0], side),
            np.arctan2(rotation[1, 0], rotation[0, 0]),
        ]
    )
