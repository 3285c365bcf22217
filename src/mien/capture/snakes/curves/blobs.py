"""Blobs [B] §3.2: the pixels of a feature, grown from seeds inside its rectangle."""

from __future__ import annotations

from math import exp

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.capture.snakes.curves.lens import boxed, upper_curve
from mien.capture.snakes.head.patch import COARSE

Array = NDArray[np.float64]
Field = NDArray[np.float32]
Mask = NDArray[np.uint8]

_OPEN, _JOIN, _JOIN_COARSE = (np.ones((side, side), np.uint8) for side in (2, 5, 3))
_LEAST, _MOST = 0.3, 0.7
"""What a rectangle's own threshold may be: I is made to be about 1 on features and 0 on skin."""
_SEED = 0.15
"""Above the threshold, from where a blob may start."""
_NEAR = 25.0
"""Patch units from the expected place at which a blob counts six tenths."""
_HAIR, _TALL = 0.5, 24
"""What is brighter than the one in a brow's rectangle, and taller than the other (patch units), is
hair."""
_LID_MARGIN = 5.0
"""Patch units above an eye where a brow may begin."""
_FEWEST = 20
"""Pixels of a blob."""


def threshold(field: Field) -> float:
    """The value that parts the rectangle's histogram best (Otsu 1979), within bounds."""
    levels = (field * 255.0).astype(np.uint8)
    parted, _ = cv2.threshold(levels, 0, 255, cv2.THRESH_BINARY + cv2.THRESH_OTSU)
    return min(max(parted / 255.0, _LEAST), _MOST)


def find_blob(field: Field, expected: Array, pitch: float = 1.0) -> Mask | None:
    """(H, W) 0 or 1: the blob of ``field`` that is largest and nearest to ``expected`` (2,),
    pixels of the field, which are ``pitch`` patch units apart; None where there is none."""
    level = threshold(field)
    mask = (field > level).view(np.uint8)
    if pitch == 1.0:
        mask = np.asarray(cv2.morphologyEx(mask, cv2.MORPH_OPEN, _OPEN), dtype=np.uint8)
    joined = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, _JOIN if pitch == 1.0 else _JOIN_COARSE)
    _, label, facts, middles = cv2.connectedComponentsWithStats(joined, connectivity=4)
    worths = []
    # A handful of blobs: what NumPy would do for them takes it longer than it takes Python.
    x, y = expected.tolist()
    for (u, v), area in zip(middles.tolist(), facts[:, cv2.CC_STAT_AREA].tolist(), strict=True):
        away = pitch**2 * ((u - x) ** 2 + (v - y) ** 2)
        worths.append(area * exp(-away / (2.0 * _NEAR**2)) if pitch**2 * area >= _FEWEST else 0.0)
    for blob in sorted(range(1, len(worths)), key=worths.__getitem__, reverse=True):
        chosen = (label == blob).view(np.uint8)
        if worths[blob] > 0.0 and cv2.minMaxLoc(field, chosen)[1] > level + _SEED:
            return np.asarray(chosen)
    return None


def blob_lens(blob: Mask, corner: Array, pitch: float = 1.0) -> Array:
    """(6, 2) the first guess of the outline of a blob whose first pixel is at ``corner``."""
    left, right, top, bottom = _extent(blob)
    return boxed(pitch * left + corner, pitch * right + corner, pitch * top, pitch * bottom)


@njit(cache=True, nogil=True)
def _extent(blob: Mask) -> tuple[Array, Array, float, float]:
    """The ends of a blob, and how far it reaches above and below their chord."""
    rows, columns = blob.shape
    first, last = columns, -1
    for y in range(rows):
        for x in range(columns):
            if blob[y, x]:
                first, last = min(first, x), max(last, x)
    left, right = np.empty(2), np.empty(2)
    left[0], left[1] = first, _middle(blob, first)
    right[0], right[1] = last, _middle(blob, last - 1)
    across, down = right[0] - left[0], right[1] - left[1]
    length = max(np.hypot(across, down), 1.0)
    highest, lowest = 0.5, 0.5
    for y in range(rows):
        for x in range(columns):
            if blob[y, x]:
                below = ((y - left[1]) * across - (x - left[0]) * down) / length
                highest, lowest = max(highest, -below), max(lowest, below)
    return left, right, highest, lowest


@njit(cache=True, nogil=True)
def _middle(blob: Mask, column: int) -> float:
    """The mean row of a blob's pixels in a ``column`` and the next."""
    total, count = 0.0, 0
    for y in range(len(blob)):
        for x in range(max(column, 0), min(column + 2, blob.shape[1])):
            if blob[y, x]:
                total += y
                count += 1
    return total / max(count, 1)


def without_hair(field: Field, expected: Array) -> Field:
    """``field`` of a brow with what hangs in from its rectangle's rim put out, unless that is the
    brow itself (hair over it): ``expected`` (2,) its middle, pixels of the field."""
    _, label, facts, _ = cv2.connectedComponentsWithStats(
        (field > _HAIR).view(np.uint8), connectivity=4
    )
    columns = field.shape[1]
    middle = float(expected[0])
    kept = np.ones(len(facts), np.float32)
    for region, (left, top, width, height, _) in enumerate(facts.tolist()):
        at_rim = left == 0 or left + width == columns or top == 0
        over = left < middle < left + width
        if region > 0 and at_rim and not over and COARSE * height > _TALL:
            kept[region] = 0.0
    return field if kept.all() else field * kept[label]


def above(field: Field, lens: Array, corner: Array) -> Field:
    """``field`` of a brow with the eye ``lens`` (6, 2) and all below it put out."""
    edge = (upper_curve(lens) - corner - np.array([0.0, _LID_MARGIN])) / COARSE
    rows = field.shape[0]
    below = np.array([[edge[-1, 0], rows], [edge[0, 0], rows]])
    result = field.copy()
    cv2.fillPoly(result, [np.round(np.concatenate([edge, below])).astype(np.int32)], 0.0)
    return result
