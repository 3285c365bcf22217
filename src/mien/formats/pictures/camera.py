"""A camera as a recording that ends when it is told to."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from mien.errors import InputError
from mien.performance.frame import Frame


@dataclass(frozen=True, slots=True)
class Camera:
    """Pictures of camera ``index``, at the times they arrived, for ``seconds``."""

    index: int
    size: tuple[int, int]
    """(width, height)"""
    rate: float
    """Frames a second, by the camera's own account."""
    seconds: float
    mirror: bool

    @property
    def name(self) -> str:
        return f"camera:{self.index}"

    @property
    def count(self) -> int:
        return round(self.seconds * self.rate)

    def __iter__(self) -> Iterator[Frame]:
        device = _open(self.index)
        try:
            begin: float | None = None
            while True:
                ok, image = device.read()
                now = perf_counter()
                if not ok:
                    raise InputError(f"{self.name}: the camera stopped giving pictures")
                begin = now if begin is None else begin
                if now - begin >= self.seconds:
                    return
                step = -1 if self.mirror else 1
                yield Frame(np.ascontiguousarray(image[:, ::step, ::-1]), now - begin)
        finally:
            device.release()


def open_camera(index: int, seconds: float, mirror: bool = False) -> Camera:
    """Look whether the camera is there and how large its pictures are.

    Raises InputError without one.
    """
    device = _open(index)
    try:
        ok, image = device.read()
        if not ok:
            raise InputError(
                f"camera:{index}: the camera gives no pictures; is it in use elsewhere?"
            )
        return Camera(index, image.shape[1::-1], device.get(5) or 30.0, seconds, mirror)
    finally:
        device.release()


def _open(index: int) -> Any:
    import cv2  # a fifth of a second, and only cameras need it here

    cv2.utils.logging.setLogLevel(cv2.utils.logging.LOG_LEVEL_SILENT)
    device = cv2.VideoCapture(index)
    if not device.isOpened():
        raise InputError(f"camera:{index}: no such camera; try camera:0, or name a video file")
    return device
