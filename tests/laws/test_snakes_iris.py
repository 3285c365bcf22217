"""Where the eyes look: dark discs between the lids, found for both eyes at once."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from mien.capture import CAPTURES, CaptureSettings
from mien.capture.snakes.aperture import aperture, tallest_runs
from mien.capture.snakes.curves.features import ROW, usual_features
from mien.capture.snakes.curves.fields import look_at
from mien.capture.snakes.curves.lens import outline
from mien.capture.snakes.curves.settle import Expected, settle
from mien.capture.snakes.head.patch import HEIGHT, ORIGIN, WIDTH
from mien.capture.snakes.iris import RADIUS, find_irises
from mien.face.animate import Poser
from mien.face.library import load_character
from mien.performance.frame import Frame
from mien.view.camera import Camera
from mien.view.renderer import Renderer

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]
SKIN, WHITE, DARK = (200, 150, 125), (215, 205, 200), (50, 35, 30)
EYES = usual_features()[[ROW["eye_right"], ROW["eye_left"]]]
MIDDLES = EYES[:, :2].mean(axis=1)


def painted(aside: Array) -> Picture:
    """A patch with both eyes open, their irises ``aside`` (2, 2) from the middle."""
    patch = np.empty((HEIGHT, WIDTH, 3), np.uint8)
    patch[:] = SKIN
    for eye, off in zip(EYES, aside, strict=True):
        inside = np.zeros((HEIGHT, WIDTH), np.uint8)
        cv2.fillPoly(inside, [np.rint(outline(eye) + ORIGIN).astype(np.int32)], 1)
        patch[inside > 0] = WHITE
        iris = np.zeros((HEIGHT, WIDTH), np.uint8)
        middle = np.rint(eye[:2].mean(axis=0) + off + ORIGIN).astype(int).tolist()
        cv2.circle(iris, middle, round(RADIUS), 1, -1)
        patch[(iris & inside) > 0] = DARK
    return np.asarray(cv2.GaussianBlur(patch, (0, 0), 1.0), dtype=np.uint8)


@pytest.mark.parametrize("aside", [0.0, 7.0, -7.0])
def test_irises_are_found_where_they_are(aside: float) -> None:
    found = find_irises(look_at(painted(np.full((2, 2), (aside, 0.0)))), MIDDLES)
    assert np.abs(found.aside[:, 0] - aside).max() < 2.0
    assert np.allclose(found.places, MIDDLES + found.aside)
    assert found.plain.min() == 1.0


def test_eyes_may_cross() -> None:
    crossed = np.array([[7.0, 0.0], [-7.0, 0.0]])
    across = find_irises(look_at(painted(crossed)), MIDDLES).aside[:, 0]
    assert across[0] > 4.0
    assert across[1] < -4.0


def test_eyes_do_not_part_but_for_what_is_usual_of_a_face() -> None:
    look = look_at(painted(np.array([[-7.0, 0.0], [7.0, 0.0]])))
    right, left = find_irises(look, MIDDLES, 0.0).aside[:, 0]
    assert left - right < 10.0
    usual = find_irises(look, MIDDLES)
    assert usual.apart == pytest.approx(14.0, abs=3.0)
    right, left = find_irises(look, MIDDLES, usual.apart).aside[:, 0]
    assert left - right > 11.0


def test_lashes_of_a_shut_eye_are_no_iris() -> None:
    patch = np.empty((HEIGHT, WIDTH, 3), np.uint8)
    patch[:] = SKIN
    for eye in EYES:
        ends = np.rint(eye[:2] + ORIGIN).astype(int).tolist()
        cv2.line(patch, ends[0], ends[1], DARK, 4)
    found = find_irises(look_at(np.asarray(cv2.GaussianBlur(patch, (0, 0), 1.0))), MIDDLES)
    assert found.plain.max() < 0.5
    assert found.apart is None


def test_a_look_to_the_subjects_left_is_positive() -> None:
    man = load_character("man")
    poser, renderer = Poser(man.face, man.keys), Renderer(man.face)
    rest, frames = np.zeros(len(man.keys.names)), []
    for number, yaw in enumerate([0.0] * 8 + [15.0] * 4 + [-15.0] * 4):
        gaze = np.tile([np.radians(yaw), 0.0], (2, 1))
        picture = renderer.render(poser.pose(rest, gaze=gaze), Camera(size=(256, 256)))
        frames.append(Frame(picture, number / 30.0))
    seen = CAPTURES["snakes"](iter(frames), CaptureSettings(neutral=(0.0, 0.2)), "eyes")
    looked = np.degrees(seen.gaze[:, :, 0].mean(axis=1))
    assert np.abs(looked[:8]).max() < 4.0
    assert looked[8:12].min() > 6.0
    assert looked[12:].max() < -6.0


@pytest.mark.parametrize(("width", "lost"), [(84.0, False), (42.0, True)])
def test_half_a_mouth_is_no_mouth(width: float, lost: bool) -> None:
    rest = usual_features()[ROW["lips"]]
    lens = rest.mean(axis=0) + (rest - rest.mean(axis=0)) * np.array([width / 82.4, 1.0])
    corner, field = np.array([-66.0, 80.0]), np.zeros((109, 132), np.float32)
    cv2.fillPoly(field, [np.rint(outline(lens) - corner).astype(np.int32)], 1.0)
    assert settle("lip", field, corner, Expected(rest, lens, True, False)).lost == lost


@pytest.mark.parametrize("seed", range(10))
def test_the_tallest_runs_equal_their_plain_twin(seed: int) -> None:
    field = np.random.default_rng(seed).random((40, 28)).astype(np.float32)
    rows = ["".join("x" if pixel > 0.5 else " " for pixel in column) for column in field.T]
    assert tallest_runs(field).tolist() == [max(map(len, row.split()), default=0) for row in rows]


@pytest.mark.parametrize("tall", [4, 12, 20])
def test_an_eye_is_as_tall_as_what_is_eye_whatever_the_brow_above(tall: int) -> None:
    field = np.zeros((40, 68), np.float32)
    field[:3] = 1.0
    field[35 - tall : 35] = 1.0
    assert aperture(field) == pytest.approx(0.9 * tall)
