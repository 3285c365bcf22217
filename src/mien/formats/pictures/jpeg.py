"""JPEG in memory, as cameras and pages send it."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError

LARGEST_SIDE = 4096
"""Pixels."""


def decode_jpeg(data: bytes) -> NDArray[np.uint8]:
    """(H, W, 3) RGB. Raises FormatError for anything else, or a picture beyond all use."""
    if data[:3] != b"\xff\xd8\xff":
        raise FormatError("not a JPEG")
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
    if image is None or max(image.shape[:2]) > LARGEST_SIDE:
        raise FormatError("a JPEG that cannot be used")
    return np.asarray(image[:, :, ::-1])


def encode_jpeg(image: NDArray[np.uint8], height: int, quality: int = 70) -> bytes:
    """A JPEG of ``image`` (H, W, 3) RGB, at most ``height`` pixels high."""
    height = min(height, image.shape[0])
    size = (max(1, round(image.shape[1] * height / image.shape[0])), height)
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    _, jpeg = cv2.imencode(".jpg", small[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])
    return jpeg.tobytes()
