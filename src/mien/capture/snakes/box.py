"""Finding the face in a frame: a cascade says about where, dark bars say where exactly."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.features import NAMES, usual_lenses
from mien.capture.snakes.lens import outline
from mien.capture.snakes.patch import Picture, Placement

Array = NDArray[np.float64]

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
_HALF_WIDTH, _ABOVE, _BELOW = 104, 68, 170
_TURNS = np.radians(np.arange(-15.0, 15.1, 5.0))
_SCALES = np.array([0.9, 0.97, 1.04, 1.12])
_TURN_SIGMA, _SCALE_SIGMA, _SHIFT_SIGMA = np.radians(25.0), 0.35, 45.0
"""How far from the cascade's word a match loses as much as a perfect one would gain."""


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
    return Placement.at(middle - half, middle + half)


def refine(image: Picture, guess: Placement) -> Placement:
    """``guess`` moved, scaled and turned until dark bars lie on brows, eyes, nostrils and mouth."""
    best, found = -np.inf, guess
    bars = _bars()
    rows, columns = bars.shape
    reach = round(_REACH * _COARSE)
    shift = np.mgrid[-reach : reach + 1, -reach : reach + 1] / _COARSE
    leaving = (shift**2).sum(0) / _SHIFT_SIGMA**2
    for turn in _TURNS:
        for scale in _SCALES:
            c, s = np.cos(turn) / scale, np.sin(turn) / scale
            trial = guess.moved(np.array([[c, s, 0.0], [-s, c, 0.0]]))
            dark = _darkness(image, trial, (columns + 2 * reach, rows + 2 * reach))
            score = cv2.matchTemplate(dark, bars, cv2.TM_CCOEFF_NORMED)
            score = score - leaving - (turn / _TURN_SIGMA) ** 2
            score -= (np.log(scale) / _SCALE_SIGMA) ** 2
            row, column = np.unravel_index(int(score.argmax()), score.shape)
            if score[row, column] > best:
                best = float(score[row, column])
                away = np.array([shift[1, row, column], shift[0, row, column]])
                found = trial.moved(np.column_stack([np.eye(2), -away]))
    return found


def _darkness(image: Picture, placement: Placement, size: tuple[int, int]) -> NDArray[np.float32]:
    """ln(local mean / brightness) of the coarse patch and its surroundings."""
    matrix = placement.matrix * _COARSE
    reach = round(_REACH * _COARSE)
    matrix[:, 2] += np.array([_HALF_WIDTH, _ABOVE]) * _COARSE + reach
    matrix[:, 2] += matrix[:, :2] @ np.array([0.5, 0.5])
    small = cv2.warpAffine(image, matrix, size, borderMode=cv2.BORDER_REPLICATE)
    value = small.max(axis=2).astype(np.float32) + 4.0
    return np.asarray(np.clip(np.log(cv2.blur(value, (11, 11)) / value), -0.3, 1.0))


@cache
def _bars() -> NDArray[np.float32]:
    """The features of a resting face drawn as dark bars on the coarse patch."""
    picture = np.zeros((round((_ABOVE + _BELOW) * _COARSE), round(2 * _HALF_WIDTH * _COARSE)), "f4")
    corner = np.array([_HALF_WIDTH, _ABOVE])
    for name, lens in zip(NAMES, usual_lenses(), strict=True):
        if name == "lips":
            middle = (lens[[0, 1]] + corner) * _COARSE
            places, closed = np.round(middle).astype(np.int32), False
        else:
            places = np.round((outline(lens) + corner) * _COARSE).astype(np.int32)
            closed = True
        if closed:
            cv2.fillPoly(picture, [places], 1.0)
        else:
            cv2.polylines(picture, [places], False, 1.0)
    return np.asarray(cv2.GaussianBlur(picture, (0, 0), 0.8))


@cache
def _cascade() -> cv2.CascadeClassifier:
    return cv2.CascadeClassifier(
        str(Path(cv2.data.haarcascades) / "haarcascade_frontalface_default.xml")
    )
