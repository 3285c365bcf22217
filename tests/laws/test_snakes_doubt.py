"""Lips that leave out what looks like lips are marked, and followed all the same."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from mien.capture.snakes.colour.pigments import pigments
from mien.capture.snakes.curves.features import usual_lenses
from mien.capture.snakes.curves.lens import outline
from mien.capture.snakes.doubt import doubtful, left_out
from mien.capture.snakes.head.patch import HEIGHT, WIDTH

Array = NDArray[np.float64]

ROWS, COLUMNS = 54, 66
BLANK = np.zeros((HEIGHT // 2, WIDTH // 2, 3), np.uint8)
SEEN = pigments(BLANK, np.ones(3), (23, 77, 23 + COLUMNS, 77 + ROWS), 2)


def lit(lens: Array) -> NDArray[np.float32]:
    """A field in which a lens alone shines."""
    field = np.zeros((ROWS, COLUMNS), np.float32)
    cv2.fillPoly(field, [np.rint(SEEN.pixels(outline(lens))).astype(np.int32)], 1.0)
    return field


def test_lips_on_all_that_shines_leave_nothing_out() -> None:
    lips = usual_lenses()["lips"]
    assert left_out(lips, lit(lips), SEEN) == 0.0
    assert not doubtful(lips, 0.4, lit(lips), SEEN)


@pytest.mark.parametrize("shift", [-14.0, 14.0])
def test_lips_beside_what_shines_are_doubtful(shift: float) -> None:
    lips = usual_lenses()["lips"]
    aside = lips + np.array([0.0, shift])
    assert left_out(aside, lit(lips), SEEN) > 0.4
    assert doubtful(aside, 0.4, lit(lips), SEEN)


def test_what_shines_far_away_is_no_lip() -> None:
    lips = usual_lenses()["lips"]
    field = lit(lips)
    field[-4:] = 1.0
    assert not doubtful(lips, 0.4, field, SEEN)


def test_dull_lips_are_doubtful_anyway() -> None:
    lips = usual_lenses()["lips"]
    assert doubtful(lips, 0.05, lit(lips), SEEN)
