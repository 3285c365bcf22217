"""What a capture saw, drawn over the picture it saw it in."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.performance.trace import Trace

Picture = NDArray[np.uint8]
Array = NDArray[np.float64]
Colour = tuple[int, int, int]

_FINE = 4
"""Bits of a pixel's fraction in OpenCV's drawing."""
_BOX, _POINT, _WIRE, _NOTE = (240, 200, 70), (90, 230, 120), (70, 150, 200), (255, 240, 160)
_AXES = ((240, 80, 80), (90, 220, 90), (90, 140, 255))
_CURVES: dict[str, Colour] = {
    "brow": (255, 150, 60),
    "eye": (255, 90, 120),
    "lid": (255, 90, 120),
    "lip": (255, 60, 60),
    "mouth": (80, 230, 255),
}
"""By the beginning of a curve's name."""
_OTHER = (200, 120, 255)
_SMALLEST, _LARGEST = 480, 720
"""Rows of the result: small pictures are enlarged, or lines would hide what they lie on."""


def overlay(image: Picture, trace: Trace) -> Picture:
    """(H', W', 3) ``image`` with ``trace`` drawn over it, and its picture beside where it has
    one."""
    rows = min(max(image.shape[0], _SMALLEST), _LARGEST)
    scale = rows / image.shape[0]
    canvas = _resized(image, rows)
    width = max(1, round(rows / 480))
    for ends in trace.wire:
        _line(canvas, ends * scale, _WIRE, 1)
    for corners in trace.boxes.values():
        _line(canvas, corners * scale, _BOX, 1, closed=True)
    for name, places in trace.curves.items():
        _line(canvas, places * scale, _colour(name), width)
    for place in trace.points * scale:
        cv2.circle(canvas, *_exact(place, 1.2 * width), _POINT, -1, cv2.LINE_AA, _FINE)
    for tip, colour in zip(trace.axes[1:], _AXES, strict=False):
        _line(canvas, np.stack([trace.axes[0], tip]) * scale, colour, width + 1)
    others = (f"one of {trace.faces} faces",) if trace.faces > 1 else ()
    for row, note in enumerate((*others, *trace.notes)):
        place = (8, 20 + 18 * row)
        for thickness, shade in ((3, (0, 0, 0)), (1, _NOTE)):
            cv2.putText(
                canvas, note, place, cv2.FONT_HERSHEY_SIMPLEX, 0.5, shade, thickness, cv2.LINE_AA
            )
    return canvas if trace.beside is None else np.hstack([canvas, _resized(trace.beside, rows)])


def _colour(name: str) -> Colour:
    return next((c for start, c in _CURVES.items() if name.startswith(start)), _OTHER)


def _resized(image: Picture, rows: int) -> Picture:
    columns = max(1, round(image.shape[1] * rows / image.shape[0]))
    way = cv2.INTER_AREA if rows < image.shape[0] else cv2.INTER_LINEAR
    return np.array(cv2.resize(image, (columns, rows), interpolation=way), dtype=np.uint8)


def _line(canvas: Picture, places: Array, colour: Colour, width: int, closed: bool = False) -> None:
    exact = _fixed(places)
    cv2.polylines(canvas, [exact], closed, colour, width, cv2.LINE_AA, _FINE)


def _exact(place: Array, radius: float) -> tuple[tuple[int, int], int]:
    x, y = _fixed(place).tolist()
    return (x, y), round(radius * 2**_FINE)


def _fixed(places: Array) -> NDArray[np.int32]:
    """Whole numbers of OpenCV's fraction; its first pixel's centre is (0, 0)."""
    bounded = np.clip(places, -1e4, 1e5)
    return np.asarray(np.round((bounded - 0.5) * 2**_FINE), dtype=np.int32)
