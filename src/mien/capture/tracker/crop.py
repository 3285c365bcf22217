"""The part of a frame that shows the face: all that the tracker keeps of a picture."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.errors import MienError

Floats = NDArray[np.float32]

FACE_PIXELS = 200.0
"""Length of a face in a crop; a smaller one is left as it is."""
_MARGIN = 0.25
"""Of the face's size, on every side."""
_STEP = 1.25
"""Scales are powers of it: a face that breathes must not be resampled anew in every frame."""
_LEAST = 16
_QUALITY = 95


@dataclass(frozen=True, slots=True)
class Crop:
    """A grey picture of the face; pixel u of the crop is ``scale`` (x - origin) of the frame."""

    image: NDArray[np.uint8]
    """(h, w)"""
    scale: float
    origin: tuple[float, float]

    @property
    def size(self) -> tuple[int, int]:
        """Width and height."""
        return self.image.shape[1], self.image.shape[0]


@dataclass(frozen=True, slots=True)
class Kept:
    """A crop, packed: a minute of video takes some 30 MB."""

    packed: NDArray[np.uint8]
    scale: float
    origin: tuple[float, float]


def cut(image: NDArray[np.uint8], points: NDArray[np.floating[Any]]) -> Crop:
    """The face whose landmarks are ``points`` (N, 2 or more) in ``image`` (H, W, 3) RGB. Of a face
    that is hardly in the picture, a few pixels of its border."""
    height, width = image.shape[:2]
    low, high = points[:, :2].min(0), points[:, :2].max(0)
    length = float(max(high - low))
    low, high = low - _MARGIN * length, high + _MARGIN * length
    left, top = (int(n) for n in np.clip(np.floor(low), 0, (width, height)))
    right, bottom = (int(n) for n in np.clip(np.ceil(high), 0, (width, height)))
    left, top = min(left, max(width - _LEAST, 0)), min(top, max(height - _LEAST, 0))
    right, bottom = max(right, min(_LEAST, width)), max(bottom, min(_LEAST, height))
    grey = cv2.cvtColor(np.ascontiguousarray(image[top:bottom, left:right]), cv2.COLOR_RGB2GRAY)
    scale = 1.0
    if length > FACE_PIXELS * _STEP:
        scale = _STEP ** -np.floor(np.log(length / FACE_PIXELS) / np.log(_STEP))
        # Told the scale and not the size, OpenCV keeps it exactly: no jitter of a third of a pixel.
        grey = cv2.resize(grey, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
    return Crop(np.asarray(grey, dtype=np.uint8), float(scale), (float(left), float(top)))


def pack(crop: Crop) -> Kept:
    """A crop made small. Raises MienError where it cannot be."""
    done, packed = cv2.imencode(".jpg", crop.image, [cv2.IMWRITE_JPEG_QUALITY, _QUALITY])
    if not done:
        raise MienError("a picture could not be kept in memory")
    return Kept(np.asarray(packed, dtype=np.uint8), crop.scale, crop.origin)


def unpack(kept: Kept) -> Crop:
    """The crop again, but for a grey level here and there."""
    image = cv2.imdecode(kept.packed, cv2.IMREAD_GRAYSCALE)
    return Crop(np.asarray(image, dtype=np.uint8), kept.scale, kept.origin)
