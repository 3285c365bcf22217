"""JPEG in memory, as cameras and pages send it."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError

LARGEST_SIDE = 4096
"""Pixels."""


_FRAMES = frozenset(range(0xC0, 0xD0)) - {0xC4, 0xC8, 0xCC}
"""Markers of the segments that tell a picture's size."""


def decode_jpeg(data: bytes) -> NDArray[np.uint8]:
    """(H, W, 3) RGB. Raises FormatError for anything else, or a picture beyond all use."""
    if not 0 < max(_size(data)) <= LARGEST_SIDE:
        raise FormatError("a JPEG that cannot be used")
    image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR_RGB)
    if image is None:
        raise FormatError("a JPEG that cannot be used")
    return np.asarray(image)


def _size(data: bytes) -> tuple[int, int]:
    """Height and width as the file claims them: nothing is laid out for a picture that says it is
    huge. (0, 0) where it says nothing. Raises FormatError."""
    if data[:3] != b"\xff\xd8\xff":
        raise FormatError("not a JPEG")
    place = 2
    while place + 9 <= len(data) and data[place] == 0xFF:
        marker, length = data[place + 1], int.from_bytes(data[place + 2 : place + 4])
        if marker in _FRAMES:
            height, width = (int.from_bytes(data[place + i : place + i + 2]) for i in (5, 7))
            return height, width
        place += 2 + length
    return 0, 0


def encode_jpeg(image: NDArray[np.uint8], height: int, quality: int = 70) -> bytes:
    """A JPEG of ``image`` (H, W, 3) RGB, at most ``height`` pixels high."""
    height = min(height, image.shape[0])
    size = (max(1, round(image.shape[1] * height / image.shape[0])), height)
    small = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    _, jpeg = cv2.imencode(".jpg", small[:, :, ::-1], [cv2.IMWRITE_JPEG_QUALITY, quality])
    return jpeg.tobytes()
