"""The first frame before there is one: what is compiled on first use is compiled now."""

from __future__ import annotations

from functools import cache

import cv2
import numpy as np

from mien.capture.snakes.colour.skin import USUAL_SKIN
from mien.capture.snakes.curves.features import usual_lenses
from mien.capture.snakes.curves.lens import outline
from mien.capture.snakes.head.patch import Picture, Placement
from mien.capture.snakes.stepper import SnakeCapture

_SIZE = 480
_EYES = np.array([[190.0, 200.0], [290.0, 200.0]])
_COLOURS = {"lips": (165, 85, 85), "mouth": (40, 20, 20)}
_DARK = (60, 40, 30)
_OPEN = np.array([0.7, 0.5])
"""Width and height of the drawn mouth in those of its lips: a shut one has no inside."""


@cache
def rehearse() -> None:
    """Follow a drawn face for two frames. On a new machine this takes the seconds that the first
    frames of a camera would otherwise be late."""
    capture, picture = SnakeCapture(), drawn()
    for _ in range(2):
        capture.step(picture)


def drawn() -> Picture:
    """(480, 480, 3) a usual face with its mouth open."""
    picture = np.full((_SIZE, _SIZE, 3), USUAL_SKIN, np.uint8)
    placement = Placement.at(_EYES)
    usual = usual_lenses()
    lips = usual["lips"]
    opened = lips.mean(axis=0) + _OPEN * (lips - lips.mean(axis=0))
    for name, lens in {**usual, "mouth": opened}.items():
        corners = np.rint(placement.to_frame(outline(lens))).astype(np.int32)
        cv2.fillPoly(picture, [corners], _COLOURS.get(name, _DARK))
    return picture
