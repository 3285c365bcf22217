"""Blobs [B] §3.2: the pixels of a feature, grown from seeds inside its rectangle."""

from __future__ import annotations

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.capture.snakes.curves.lens import boxed, upper_curve
from mien.capture.snakes.head.patch import COARSE

Array = NDArray[np.float64]
Field = NDArray[np.float32]
Mask = NDArray[np.uint8]
Labels = NDArray[np.int64]

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
    return min(max(float(_parting(field)), _LEAST), _MOST)


def find_blob(field: Field, expected: Array, pitch: float = 1.0) -> Mask | None:
    """(H, W) 0 or 1: the blob of ``field`` that is largest and nearest to ``expected`` (2,),
    pixels of the field, which are ``pitch`` patch units apart; None where there is none."""
    level = threshold(field)
    mask = (field > level).view(np.uint8)
    if pitch == 1.0:
        mask = np.asarray(cv2.morphologyEx(mask, cv2.MORPH_OPEN, _OPEN), dtype=np.uint8)
    by = _JOIN if pitch == 1.0 else _JOIN_COARSE
    joined = np.asarray(cv2.morphologyEx(mask, cv2.MORPH_CLOSE, by), dtype=np.uint8)
    blob, found = _likeliest(joined, field, level + _SEED, expected, pitch)
    return blob if found else None


@njit(cache=True, nogil=True)
def _parting(field: Field) -> float:
    """Otsu's threshold of values 0..1 in 256 steps."""
    counts = np.zeros(256)
    for y in range(field.shape[0]):
        for x in range(field.shape[1]):
            counts[int(field[y, x] * np.float32(255.0))] += 1.0 / field.size
    whole = 0.0
    for level in range(256):
        whole += level * counts[level]
    best, most, share, below = 0, 0.0, 0.0, 0.0
    for level in range(256):
        share += counts[level]
        below += level * counts[level]
        if 1e-7 < share < 1.0 - 1e-7:
            apart = (whole * share - below) ** 2 / (share * (1.0 - share))
            if apart > most:
                best, most = level, apart
    return best / 255.0


@njit(cache=True, nogil=True)
def _likeliest(
    mask: Mask, field: Field, seed: float, expected: Array, pitch: float
) -> tuple[Mask, bool]:
    """The region of ``mask`` that is worth most of those with a seed in them, and whether there
    is one."""
    label, facts = connected(mask)
    rows, columns = mask.shape
    seeded = np.zeros(len(facts), np.uint8)
    for y in range(rows):
        for x in range(columns):
            if field[y, x] > np.float32(seed):
                seeded[label[y, x]] = 1
    chosen, most = 0, 0.0
    for region in range(1, len(facts)):
        area = facts[region, _AREA]
        away_x = facts[region, _SUM_X] / area - expected[0]
        away_y = facts[region, _SUM_Y] / area - expected[1]
        away = pitch**2 * (away_x**2 + away_y**2)
        worth = area * np.exp(-away / (2.0 * _NEAR**2))
        if worth > most and seeded[region] and pitch**2 * area >= _FEWEST:
            chosen, most = region, worth
    blob = np.empty((rows, columns), np.uint8)
    for y in range(rows):
        for x in range(columns):
            blob[y, x] = label[y, x] == chosen
    return blob, chosen > 0


_LEFT, _TOP, _RIGHT, _BOTTOM, _AREA, _SUM_X, _SUM_Y = range(7)


@njit(cache=True, nogil=True)
def connected(mask: Mask) -> tuple[Labels, Labels]:
    """(H, W) which region each pixel of a ``mask`` belongs to, 0 for none, of pixels that share
    an edge; and (R + 1, 7) of each region its first and last column and row, how many pixels it
    has, and the sums of their columns and rows."""
    rows, columns = mask.shape
    label = np.zeros((rows, columns), np.int64)
    parent = np.arange(rows * columns // 2 + 2)
    count = 0
    for y in range(rows):
        for x in range(columns):
            if mask[y, x] == 0:
                continue
            above = label[y - 1, x] if y > 0 else 0
            beside = label[y, x - 1] if x > 0 else 0
            if above == 0 and beside == 0:
                count += 1
                label[y, x] = count
                continue
            while parent[above] != above:
                above = parent[above]
            while parent[beside] != beside:
                beside = parent[beside]
            if above == 0 or beside == 0:
                label[y, x] = above + beside
            else:
                label[y, x] = min(above, beside)
                parent[max(above, beside)] = min(above, beside)
    regions = 0
    for k in range(1, count + 1):
        if parent[k] == k:
            regions += 1
            parent[k] = regions
        else:
            parent[k] = parent[parent[k]]
    facts = np.zeros((regions + 1, 7), np.int64)
    for y in range(rows):
        for x in range(columns):
            region = parent[label[y, x]]
            label[y, x] = region
            if facts[region, _AREA] == 0:
                facts[region, _LEFT], facts[region, _TOP] = x, y
            facts[region, _LEFT] = min(facts[region, _LEFT], x)
            facts[region, _RIGHT] = max(facts[region, _RIGHT], x)
            facts[region, _BOTTOM] = y
            facts[region, _AREA] += 1
            facts[region, _SUM_X] += x
            facts[region, _SUM_Y] += y
    return label, facts


@njit(cache=True, nogil=True)
def blob_lens(blob: Mask, corner: Array, pitch: float = 1.0) -> Array:
    """(6, 2) the first guess of the outline of a blob whose first pixel is at ``corner``."""
    left, right, top, bottom = _extent(blob)
    for axis in range(2):
        left[axis] = pitch * left[axis] + corner[axis]
        right[axis] = pitch * right[axis] + corner[axis]
    return boxed(left, right, pitch * top, pitch * bottom)


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
    left[0], left[1] = first, _middle(blob, first, first + 1)
    right[0], right[1] = last, _middle(blob, last - 1, last)
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
def _middle(blob: Mask, first: int, last: int) -> float:
    """The mean row of a blob's pixels in the columns from ``first`` to ``last``."""
    total, count = 0.0, 0
    for y in range(len(blob)):
        for x in range(max(first, 0), min(last + 1, blob.shape[1])):
            if blob[y, x]:
                total += y
                count += 1
    return total / max(count, 1)


@njit(cache=True, nogil=True)
def without_hair(field: Field, expected: Array) -> Field:
    """``field`` of a brow with what hangs in from its rectangle's rim put out, unless that is the
    brow itself (hair over it): ``expected`` (2,) its middle, pixels of the field."""
    rows, columns = field.shape
    hair = np.empty((rows, columns), np.uint8)
    for y in range(rows):
        for x in range(columns):
            hair[y, x] = field[y, x] > _HAIR
    label, facts = connected(hair)
    hanging = np.zeros(len(facts), np.uint8)
    for region in range(1, len(facts)):
        first, last = facts[region, _LEFT], facts[region, _RIGHT]
        at_rim = first == 0 or last == columns - 1 or facts[region, _TOP] == 0
        over = first < expected[0] < last + 1
        tall = COARSE * (facts[region, _BOTTOM] - facts[region, _TOP] + 1) > _TALL
        hanging[region] = at_rim and tall and not over
    combed = np.empty((rows, columns), np.float32)
    for y in range(rows):
        for x in range(columns):
            combed[y, x] = np.float32(0.0) if hanging[label[y, x]] else field[y, x]
    return combed


def above(field: Field, lens: Array, corner: Array) -> Field:
    """``field`` of a brow with the eye ``lens`` (6, 2) and all below it put out."""
    edge = (upper_curve(lens) - corner - np.array([0.0, _LID_MARGIN])) / COARSE
    rows = field.shape[0]
    below = np.array([[edge[-1, 0], rows], [edge[0, 0], rows]])
    result = field.copy()
    cv2.fillPoly(result, [np.round(np.concatenate([edge, below])).astype(np.int32)], 0.0)
    return result
