"""Finding the face in a frame: a cascade says about where, dark bars say where exactly."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.curves.features import usual_lenses
from mien.capture.snakes.curves.lens import outline
from mien.capture.snakes.head.patch import Picture, Placement

Array = NDArray[np.float64]
Field = NDArray[np.float32]

_SEARCH_WIDTH = 320
"""Pixels to which a frame is reduced for the cascade."""
_SMALLEST = 40
"""Pixels of the reduced frame: smaller faces are not looked for."""
_EYES_IN_BOX = np.array([0.5, 0.405])
"""Where the middle between the eyes lies in the cascade's box, and how far apart eyes are."""
_EYES_APART_IN_BOX = 0.37

_COARSE = 0.25
"""Pixels of the coarse patch in a patch unit."""
_REACH = 28
"""Patch units by which the cascade may be wrong."""
_TURNS = np.radians(np.arange(-15.0, 15.1, 5.0))
_SCALES = np.array([0.8, 0.86, 0.93, 1.0, 1.08, 1.16])
_TURN_SIGMA, _SCALE_SIGMA, _SHIFT_SIGMA = np.radians(25.0), 0.3, 40.0
"""How far from the cascade's word a match loses as much as a perfect one would gain."""


@dataclass(frozen=True, slots=True)
class _Part:
    """Dark bars that keep their place to each other, and how they move against the eyes."""

    features: tuple[str, ...]
    weight: float
    flex: int
    """Patch units up or down from their usual place."""


_PARTS = (
    _Part(("eye_right", "eye_left"), 1.0, 0),
    _Part(("brow_right", "brow_left"), 0.6, 8),
    _Part(("mouth",), 0.6, 12),
)


def find_face(image: Picture) -> Placement | None:
    """Where the largest upright face of a frame (H, W, 3) is, or None."""
    box = _cascade_box(image)
    return None if box is None else refine(image, _placed(box))


def _cascade_box(image: Picture) -> tuple[float, float, float] | None:
    """Left, top and width in pixels of the frame."""
    factor = min(1.0, _SEARCH_WIDTH / max(image.shape[:2]))
    grey = cv2.cvtColor(image, cv2.COLOR_RGB2GRAY)
    small = cv2.resize(grey, None, fx=factor, fy=factor, interpolation=cv2.INTER_AREA)
    small = cv2.equalizeHist(small)
    boxes = _cascade().detectMultiScale(small, 1.1, 3, minSize=(_SMALLEST, _SMALLEST))
    if len(boxes) == 0:
        return None
    left, top, width, _ = max(boxes, key=lambda box: int(box[2]))
    return left / factor, top / factor, width / factor


def _placed(box: tuple[float, float, float]) -> Placement:
    left, top, width = box
    middle = np.array([left, top]) + width * _EYES_IN_BOX
    half = np.array([width * _EYES_APART_IN_BOX / 2.0, 0.0])
    return Placement.at(np.stack([middle - half, middle + half]))


def refine(image: Picture, guess: Placement) -> Placement:
    """``guess`` moved, scaled and turned until dark bars lie on eyes, brows and mouth."""
    best, found = -np.inf, guess
    reach = round(_REACH * _COARSE)
    shift = np.mgrid[-reach : reach + 1, -reach : reach + 1] / _COARSE
    leaving = (shift**2).sum(0) / _SHIFT_SIGMA**2
    for turn in _TURNS:
        for scale in _SCALES:
            c, s = np.cos(turn) / scale, np.sin(turn) / scale
            trial = guess.moved(np.array([[c, s, 0.0], [-s, c, 0.0]]))
            score = _likeness(*_cues(image, trial)) - leaving
            score -= (turn / _TURN_SIGMA) ** 2 + (np.log(scale) / _SCALE_SIGMA) ** 2
            row, column = np.unravel_index(int(score.argmax()), score.shape)
            if score[row, column] > best:
                best = float(score[row, column])
                away = np.array([shift[1, row, column], shift[0, row, column]])
                found = trial.moved(np.column_stack([np.eye(2), -away]))
    return found


_PALE = 2.0
"""How much paler counts against darker."""
_AROUND = (11, 11)
_LEFT, _TOP, _RIGHT, _BOTTOM = -108, -72, 108, 136
"""Patch units that the bars cover."""
_MARGIN = _REACH + max(part.flex for part in _PARTS)


def _cues(image: Picture, placement: Placement) -> tuple[Field, Field]:
    """What is darker than its surroundings on the coarse patch, and what is darker or paler: only
    eyes have white beside dark."""
    matrix = placement.matrix * _COARSE
    matrix[:, 2] += (_MARGIN - np.array([_LEFT, _TOP])) * _COARSE
    matrix[:, 2] += matrix[:, :2] @ np.array([0.5, 0.5])
    size = [round((2 * _MARGIN + side) * _COARSE) for side in (_RIGHT - _LEFT, _BOTTOM - _TOP)]
    small = cv2.warpAffine(image, matrix, size, borderMode=cv2.BORDER_REPLICATE)
    value = small.max(axis=2).astype(np.float32) + 4.0
    tint = (value - small.min(axis=2)) / value
    dark = np.clip(np.log(cv2.blur(value, _AROUND) / value), -0.3, 1.0)
    pale = np.clip(cv2.blur(tint, _AROUND) - tint, -0.1, 0.5)
    return dark, dark + _PALE * pale


def _likeness(dark: Field, eyes: Field) -> Field:
    """(2 reach + 1, 2 reach + 1) how well the bars fit at each shift."""
    reach = round(_REACH * _COARSE)
    total = np.zeros((2 * reach + 1, 2 * reach + 1), np.float32)
    for part, (bars, row, column) in zip(_PARTS, _bars(), strict=True):
        flex = round(part.flex * _COARSE)
        margin = round(_MARGIN * _COARSE)
        rows, columns = bars.shape
        top, left = margin + row - reach - flex, margin + column - reach
        window = (eyes if part.flex == 0 else dark)[
            top : top + rows + 2 * (reach + flex), left : left + columns + 2 * reach
        ]
        match = cv2.matchTemplate(window, bars, cv2.TM_CCOEFF_NORMED)
        match = cv2.dilate(match, np.ones((2 * flex + 1, 1), np.uint8))
        total += part.weight * match[flex : flex + 2 * reach + 1]
    return total


@cache
def _bars() -> tuple[tuple[NDArray[np.float32], int, int], ...]:
    """Each part of a resting face drawn on the coarse patch, with its first row and column."""
    return tuple(_drawn(part.features) for part in _PARTS)


def _drawn(features: tuple[str, ...]) -> tuple[NDArray[np.float32], int, int]:
    known = usual_lenses()
    corner = np.array([_LEFT, _TOP])
    whole = [round((_BOTTOM - _TOP) * _COARSE), round((_RIGHT - _LEFT) * _COARSE)]
    picture = np.zeros(whole, np.float32)
    for name in features:
        places = np.round((outline(known[name]) - corner) * _COARSE).astype(np.int32)
        cv2.fillPoly(picture, [places], 1.0)
        cv2.polylines(picture, [places], True, 1.0)
    rows, columns = np.nonzero(picture)
    top, left = max(rows.min() - 3, 0), max(columns.min() - 3, 0)
    soft = np.asarray(cv2.GaussianBlur(picture, (0, 0), 0.8), dtype=np.float32)
    return soft[top : rows.max() + 4, left : columns.max() + 4], int(top), int(left)


@cache
def _cascade() -> cv2.CascadeClassifier:
    return cv2.CascadeClassifier(
        str(Path(cv2.__file__).parent / "data" / "haarcascade_frontalface_default.xml")
    )
