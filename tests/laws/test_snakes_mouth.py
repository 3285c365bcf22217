"""What shows between the lips: tongue is told from teeth and dark, and "not seen" from zero."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from mien.capture import CAPTURES, CaptureSettings
from mien.capture.snakes.colour.pigments import Pigments
from mien.capture.snakes.curves.features import usual_lenses
from mien.capture.snakes.curves.lens import tallness
from mien.capture.snakes.mouth import (
    Inside,
    LipColour,
    filled,
    find_opening,
    hull_edges,
    look_inside,
)
from mien.capture.snakes.stepper import SnakeCapture
from mien.capture.snakes.tongue import Tongue, find_tongue
from mien.face.library import load_character
from mien.performance.frame import Frame
from mien.view.camera import Camera
from mien.view.renderer import Renderer

SKIN, LIP, DARK = (200.0, 150.0, 125.0), (170.0, 80.0, 82.0), (45.0, 25.0, 25.0)
TONGUE, TEETH = (180.0, 115.0, 115.0), (215.0, 190.0, 175.0)
SHADED_TEETH = (190.0, 155.0, 143.0)
PALE_LIP, RED_TONGUE = (200.0, 134.0, 108.0), (200.0, 80.0, 75.0)

Array = NDArray[np.float64]
Colour = tuple[float, float, float]

USUAL = Tongue(0.0, 12.0)
CORNER = np.array([-70.0, 60.0])


def painted(picture: Array, lips: Array, lip: Colour) -> tuple[Pigments, Inside]:
    """A picture whose first pixel lies at CORNER, and what is within ``lips`` of that colour."""
    value = picture.max(axis=2).astype(np.float32)
    magenta = (1.0 - picture[..., 1] / value).astype(np.float32)
    blue = (picture[..., 2] / picture[..., 1]).astype(np.float32)
    seen = Pigments(value, magenta, blue, CORNER, 1)
    return seen, look_inside(lips, seen, LipColour(lip[0], 1.0 - lip[1] / lip[0]))


def shut(lip: Colour = LIP) -> tuple[Array, Array, tuple[int, int]]:
    """A picture of lips in skin, their lens, and the row and column of their middle."""
    lips = usual_lenses()["lips"]
    lips = lips.mean(axis=0) + (lips - lips.mean(axis=0)) * np.array([1.0, 2.5])
    picture = np.tile(np.array(SKIN), (130, 140, 1))
    blank = np.zeros(picture.shape[:2], np.float32)
    picture[filled(lips, Pigments(blank, blank, blank, CORNER, 1)) > 0] = lip
    row, column = (np.round(lips.mean(axis=0) - CORNER)[::-1]).astype(int)
    return picture, lips, (int(row), int(column))


def mouth(
    inner: Colour,
    low: Colour,
    lip: Colour = LIP,
    bottom: int = 9,
    usual: Tongue = USUAL,
) -> Tongue:
    """What is found in a painted mouth: dark above, ``inner`` and ``low`` below one another, down
    to row ``bottom`` from the middle."""
    picture, lips, (row, column) = shut(lip)
    across = slice(column - 22, column + 23)
    for first, last, paint in ((-14, -6, DARK), (-6, 4, inner), (4, bottom, low)):
        picture[row + first : row + last, across] = paint
    seen, inside = painted(picture, lips, lip)
    return find_tongue(lips, find_opening(lips, seen, inside).lens, seen, inside, usual)


@pytest.mark.parametrize(("thick", "open_"), [(3, False), (7, True)])
def test_a_bent_line_between_shut_lips_is_no_opening(thick: int, open_: bool) -> None:
    picture, lips, (row, column) = shut()
    for x in range(-30, 31):
        top = row + round(x * x / 100)
        picture[top : top + thick, column + x] = DARK
    lens = find_opening(lips, *painted(picture, lips, LIP)).lens
    assert (tallness(lens) > 4.0) == open_


@pytest.mark.parametrize("top", [-8, -30])
def test_shaded_teeth_count_where_lips_lie_round_them(top: int) -> None:
    picture, lips, (row, column) = shut()
    picture[row + top : row + 8, column - 25 : column + 26] = SHADED_TEETH
    picture[row + 8 : row + 11, column - 25 : column + 26] = DARK
    lens = find_opening(lips, *painted(picture, lips, LIP)).lens
    assert (tallness(lens) > 12.0) == (top == -8)


@pytest.mark.parametrize(
    ("inner", "low", "out"),
    [
        (TONGUE, TONGUE, True),
        (TONGUE, TEETH, False),
        (TONGUE, SHADED_TEETH, False),
        (TEETH, TEETH, False),
        (DARK, DARK, False),
        (LIP, LIP, False),
        (SKIN, SKIN, False),
    ],
)
def test_a_tongue_is_pale_pink_under_dark_and_above_no_teeth(
    inner: tuple[float, float, float], low: tuple[float, float, float], out: bool
) -> None:
    assert (mouth(inner, low).out > 0.5) == out


def test_a_tongue_redder_than_pale_lips_is_out_where_it_covers_the_lower_one() -> None:
    assert mouth(RED_TONGUE, RED_TONGUE, PALE_LIP, bottom=40).out > 0.5
    assert mouth(RED_TONGUE, RED_TONGUE, PALE_LIP).out < 0.5


def test_what_is_no_thicker_than_the_lip_is_no_tongue() -> None:
    assert mouth(TONGUE, TONGUE).out > 0.5
    assert mouth(TONGUE, TONGUE, usual=Tongue(0.0, 60.0)).out == 0.0


def test_what_is_mostly_there_is_no_tongue() -> None:
    often = Tongue(0.0, 12.0, pink=0.2, frames=100)
    assert mouth(TONGUE, TONGUE, usual=often).out < mouth(TONGUE, TONGUE).out
    known = USUAL
    for inner in [TONGUE] * 20 + [LIP]:
        assert known.pink == 0.0, "nothing is learnt while the tongue is out"
        known = mouth(inner, inner, usual=known)
    assert known.pink > 0.03


def test_a_tongue_held_out_stays_out() -> None:
    known = USUAL
    for _ in range(200):
        known = mouth(TONGUE, TONGUE, usual=known)
    assert known.out > 0.5


@pytest.mark.parametrize("seed", range(20))
def test_the_hull_kernel_equals_its_opencv_twin(seed: int) -> None:
    noise = np.random.default_rng(seed).random((40, 60))
    mask = (cv2.GaussianBlur(noise, (0, 0), 3.0) > 0.51).astype(np.uint8)
    rows, columns = np.nonzero(mask)
    hull = cv2.convexHull(np.stack([columns, rows], 1).astype(np.int32)).astype(np.float32)
    upper, lower = hull_edges(mask)
    assert (upper[:, 1] <= lower[:, 1] + 1e-9).all()
    for x, y in np.concatenate([upper, lower]).tolist():
        assert abs(cv2.pointPolygonTest(hull, (x, y), True)) < 1e-3


def test_a_covered_mouth_is_marked_and_keeps_its_place() -> None:
    bare = Renderer(load_character("man").face).render(
        load_character("man").face.vertices, Camera(size=(256, 256))
    )
    first = SnakeCapture().step(bare)
    assert first is not None
    middle = first.placement.to_frame(np.array([[0.0, 105.0]]))[0].astype(int)
    covered = bare.copy()
    covered[middle[1] - 22 : middle[1] + 40, middle[0] - 45 : middle[0] + 46] = bare[
        tuple(first.placement.to_frame(np.array([[50.0, 50.0]]))[0].astype(int)[::-1])
    ]
    frames = [Frame(picture, i / 30.0) for i, picture in enumerate([bare] * 4 + [covered] * 4)]
    performance = CAPTURES["snakes"](iter(frames), CaptureSettings(), "film")
    seen = performance.scalars["mouth_seen"]
    assert seen.tolist() == [1.0] * 4 + [0.0] * 4
    assert (performance.confidence[4:] < performance.confidence[:4].min()).all()
    assert not performance.lost.any()
    assert np.abs(performance.motion[4:] - performance.motion[3]).max() < 1.5
