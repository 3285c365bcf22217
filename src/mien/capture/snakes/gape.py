"""An open mouth as it shows before the lips are known: a hole in them, or teeth above one.

The lips of a wide mouth are a thin ring, on which curves hold badly; so what it encloses is lit up
too. To be dark says little, moustaches and the shadow under the nose are as dark. But lips lie all
round a hole, and below teeth where a moustache or a sneer hides the upper one.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.capture.snakes.colour.pigments import Pigments
from mien.capture.snakes.colour.transform import Field
from mien.capture.snakes.curves.lens import boxed
from mien.capture.snakes.mouth import LipColour, bright, median, teeth

Array = NDArray[np.float64]
Mask = NDArray[np.uint8]

_LIT, _HOLE = 0.4, 0.3
"""Mean I of what counts as lips, and I of what does not."""
_PALER = 0.4
"""I of teeth in that of skin. Shade and soft pictures make teeth pink, but of all that is bright in
a face they stay least like lips."""
_FILL, _BRIGHTEST = 1.6, 0.9
"""I of what they enclose, in that of its rim, and at most: no brighter than the lips, or curves
would lie on its rim instead of theirs."""
_FEWEST = 32.0
"""Squared patch units."""
_DEEP = 2
"""Pixels for which lips are looked at."""
_NEAR = np.ones((2 * _DEEP + 1, 2 * _DEEP + 1), np.uint8)
_UPPER_LIP, _LOWER_LIP, _CORNER = 9.0, 16.0, 10.0
"""Patch units from a mouth's inside to the lips' outline."""


@dataclass(frozen=True, slots=True)
class Gape:
    """An open mouth."""

    field: Field
    """(H, W) the lips' field with the mouth lit up."""
    lens: Array | None
    """(6, 2) lips round the widest part of it, patch units; None where nothing is open."""


def find_gape(field: Field, seen: Pigments, lips: LipColour) -> Gape:
    """The open mouth in the lips' ``field``, of the same pixels as ``seen``."""
    pale = (field < _PALER * median(field.ravel())) & bright(seen, lips)
    white = teeth(seen, lips) | pale.view(np.uint8)
    parts = ((field < _HOLE).view(np.uint8), False), (white, True)
    lit, most, widest = field, 0, None
    for mask, below in parts:
        _, *found, _ = cv2.connectedComponentsWithStats(mask, connectivity=4)
        label, boxes = (np.asarray(each, dtype=np.int32) for each in found)
        fewest = _FEWEST / seen.pitch**2
        rim = np.asarray(cv2.morphologyEx(mask, cv2.MORPH_GRADIENT, _NEAR), dtype=np.uint8)
        worth, best = _worths(label, rim, boxes, field, fewest, below)
        if best > 0:
            lit = np.maximum(lit, worth[label])
        if best > 0 and boxes[best, cv2.CC_STAT_AREA] > most:
            most, widest = boxes[best, cv2.CC_STAT_AREA], boxes[best]
    return Gape(lit, None if widest is None else _lips_round(widest, seen))


def _lips_round(box: NDArray[np.int32], seen: Pigments) -> Array:
    """(6, 2) lips round the ``box`` (left, top, width, height, area) of a mouth's inside."""
    left, top, width, height = seen.pitch * box[:4].astype(float)
    middle = seen.corner + np.array([left, top + 0.5 * height])
    out = np.array([_CORNER, 0.0])
    ends = middle - out, middle + out + np.array([width, 0.0])
    return boxed(*ends, 0.5 * height + _UPPER_LIP, 0.5 * height + _LOWER_LIP)


@njit(cache=True, nogil=True)
def _worths(
    label: NDArray[np.int32],
    rim: Mask,
    boxes: NDArray[np.int32],
    field: Field,
    fewest: float,
    below: bool,
) -> tuple[Field, int]:
    """(N,) I that each component gets, 0 for those without lips round (or ``below``) it, and the
    largest of the others, or 0. ``rim`` (H, W) is 1 where there is more than one of them within
    _DEEP pixels; ``boxes`` (N, 5): left, top, width, height, area."""
    rows, columns = label.shape
    count = len(boxes)
    total, pixels = np.zeros(count), np.zeros(count)
    noted = np.full(count, -1)
    aside = 0 if below else _DEEP
    for y in range(rows):
        for x in range(columns):
            if rim[y, x] == 0:
                continue
            own = label[y, x]
            for v in range(max(y - _DEEP, 0), min(y + aside, rows - 1) + 1):
                for u in range(max(x - aside, 0), min(x + aside, columns - 1) + 1):
                    other = label[v, u]
                    if other != own and noted[other] != y * columns + x:
                        noted[other] = y * columns + x
                        total[other] += field[y, x]
                        pixels[other] += 1.0
    worth = np.zeros(count, dtype=np.float32)
    best = 0
    for n in range(1, count):
        left, top, width, height, area = boxes[n]
        enclosed = left > 0 and top > 0 and left + width < columns and top + height < rows
        mean = total[n] / max(pixels[n], 1.0)
        if enclosed and area >= fewest and mean > _LIT:
            worth[n] = min(_FILL * mean, _BRIGHTEST)
            if best == 0 or area > boxes[best, 4]:
                best = n
    return worth, best
