"""The curve capture on a face that is rendered: found, followed, lost, and never invented."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from mien.capture import CAPTURES, CaptureSettings
from mien.capture.known import curve_calibration
from mien.capture.learn import drawn_lenses, mesh_lenses
from mien.capture.snakes.colour.regions import means, subareas
from mien.capture.snakes.colour.training import GROUPS, teach
from mien.capture.snakes.curves.features import LASTING, MOUTH, NAMES, ROW, usual_lenses
from mien.capture.snakes.curves.lens import height, outline
from mien.capture.snakes.curves.settle import Expected, settle
from mien.capture.snakes.head.patch import Placement
from mien.capture.snakes.stepper import Appearance, SnakeCapture
from mien.capture.snakes.watch import trace_of
from mien.errors import FormatError, NoFaceError
from mien.face.animate import Poser
from mien.face.library import load_character
from mien.numeric.rotation import from_vector
from mien.performance.frame import Frame
from mien.performance.performer import Performer
from mien.performance.trace import Trace
from mien.view.camera import Camera
from mien.view.renderer import Renderer

Picture = NDArray[np.uint8]
FRAMES = 14
GREY = np.full((256, 256, 3), 128, np.uint8)


@pytest.fixture(scope="module")
def film() -> list[Picture]:
    """The man opens his mouth."""
    man = load_character("man")
    poser, renderer = Poser(man.face, man.keys), Renderer(man.face)
    jaw = man.keys.names.index("jaw_open")
    pictures = []
    for i in range(FRAMES):
        weights = np.zeros(len(man.keys.names))
        weights[jaw] = max(0.0, (i - 4) / (FRAMES - 5))
        pictures.append(renderer.render(poser.pose(weights), Camera(size=(256, 256))))
    return pictures


def frames(pictures: list[Picture]) -> Iterator[Frame]:
    for number, picture in enumerate(pictures):
        yield Frame(picture, number / 30.0)


def test_the_patch_comes_back_to_the_frame() -> None:
    placement = Placement.at(np.array([[210.0, 190.0], [305.0, 160.0]]))
    places = np.random.default_rng(1).uniform(-80, 80, (20, 2))
    assert np.allclose(placement.to_patch(placement.to_frame(places)), places)
    assert np.allclose(
        placement.to_patch(np.array([[210.0, 190.0], [305.0, 160.0]])), [[-50, 0], [50, 0]]
    )


def test_subareas_are_eleven_and_inside_the_patch() -> None:
    assert len(subareas()) == 11
    shade = np.tile(np.arange(112, dtype=np.float32), (132, 1))
    seen = dict(zip(subareas(), means(shade), strict=True))
    assert seen["cheek_right"] < seen["nostrils"] < seen["cheek_left"]


def test_a_rendered_face_is_found_and_its_mouth_followed(film: list[Picture]) -> None:
    stepper = SnakeCapture()
    seen = [stepper.step(picture) for picture in film]
    found = [each for each in seen if each is not None]
    assert len(found) == FRAMES
    eyes = found[0].placement.to_frame(np.array([[-50.0, 0.0], [50.0, 0.0]]))
    # The camera looks straight at a face whose eyes are above the middle of the picture.
    assert abs(eyes.mean(axis=0)[0] - 128.0) < 6.0
    heights = [float(height(each.lenses[ROW["lips"]])) for each in found]
    assert heights[-1] > heights[0] + 4.0
    assert not any(each.recovered for each in found[1:])


def test_watching_changes_nothing_and_is_told_every_frame(film: list[Picture]) -> None:
    told: list[Trace] = []
    plain = CAPTURES["snakes"](frames(film), CaptureSettings(), "film")
    watched = CAPTURES["snakes"](frames(film), CaptureSettings(watch=told.append), "film")
    assert np.array_equal(plain.motion, watched.motion)
    assert len(told) == FRAMES
    assert {f"{NAMES[row]}_upper" for row in np.flatnonzero(LASTING)} <= set(told[0].curves)
    assert told[0].beside is not None
    assert len(plain.points) == 20
    assert {"lid_left", "lid_right", "tongue_out", "mouth_seen"} <= set(plain.scalars)


def test_a_face_that_goes_is_lost_and_found_again(film: list[Picture]) -> None:
    there = film[:4]
    performance = CAPTURES["snakes"](
        frames([*there, GREY, GREY, *there]), CaptureSettings(), "film"
    )
    assert performance.lost.tolist() == [False] * 4 + [True] * 2 + [False] * 4
    assert (performance.confidence[performance.lost] == 0.0).all()
    assert np.array_equal(performance.motion[4], performance.motion[3])


@pytest.mark.parametrize("size", [(48, 64), (256, 256), (1, 1), (1000, 3)])
def test_pictures_without_a_face_are_told(size: tuple[int, int]) -> None:
    pictures = [np.full((*size, 3), shade, np.uint8) for shade in (0, 128, 255)]
    with pytest.raises(NoFaceError, match="no face was found in 3 frames"):
        CAPTURES["snakes"](frames(pictures), CaptureSettings(), "nothing")


def test_noise_is_never_a_face() -> None:
    random = np.random.default_rng(2)
    pictures = [random.integers(0, 255, (120, 160, 3), dtype=np.uint8) for _ in range(3)]
    with pytest.raises(NoFaceError):
        CAPTURES["snakes"](frames(pictures), CaptureSettings(), "noise")


def test_a_known_performer_is_read_alike_frame_by_frame(film: list[Picture]) -> None:
    stepper = SnakeCapture()
    first = stepper.step(film[0])
    assert first is not None
    known = stepper.appearance
    assert isinstance(known, Appearance)
    one, other = SnakeCapture(known), SnakeCapture(known)
    whole = [one.step(picture) for picture in film]
    for picture, seen in zip(film, whole, strict=True):
        again = other.step(picture)
        assert again is not None
        assert seen is not None
        assert np.array_equal(again.lenses, seen.lenses)
        assert np.array_equal(again.placement.matrix, seen.placement.matrix)


@pytest.mark.parametrize(("lean", "lost"), [(0.0, False), (20.0, False), (50.0, True)])
def test_a_shadow_between_fingers_is_no_mouth(lean: float, lost: bool) -> None:
    rest = usual_lenses()["lips"]
    middle, corner = rest.mean(axis=0), np.array([-80.0, 70.0])
    turn = from_vector(np.array([0.0, 0.0, np.radians(lean)]))[:2, :2]
    leaning = middle + (rest - middle) @ turn.T
    mask = np.zeros((140, 160), np.uint8)
    cv2.fillPoly(mask, [np.round(outline(leaning) - corner).astype(np.int32)], 1)
    expected = Expected(rest, leaning, known=True, lost=False)
    assert settle("lip", mask.astype(np.float32), corner, expected).lost == lost


@pytest.mark.parametrize(("shade", "lost"), [(1.0, False), (0.1, True)])
def test_nostrils_are_seen_only_where_something_is_dark(shade: float, lost: bool) -> None:
    rest, corner = usual_lenses()["nostril_left"], np.array([2.0, 46.0])
    mask = np.zeros((38, 38), np.float32)
    cv2.fillPoly(mask, [np.round(outline(rest) - corner + 3.0).astype(np.int32)], shade)
    found = settle("nostril", mask, corner, Expected(rest, rest, known=False, lost=False))
    assert found.lost == lost
    if not lost:
        assert np.abs(found.lens.mean(axis=0) - rest.mean(axis=0) - 3.0).max() < 1.0


def test_curves_that_are_lost_are_not_drawn(film: list[Picture]) -> None:
    seen = SnakeCapture().step(film[0])
    assert seen is not None
    lost = np.array([name == "lips" for name in NAMES])
    drawn = trace_of(replace(seen, lost=lost))
    assert not any(name.startswith(("lips", "mouth")) for name in drawn.curves)
    assert "lips lost" in drawn.notes


def test_networks_are_taught_from_known_features(film: list[Picture]) -> None:
    seen = SnakeCapture().step(film[0])
    assert seen is not None
    networks = teach([(seen.look.patch, seen.lenses)])
    assert set(networks) == set(GROUPS)
    assert all(np.isfinite(each.hidden).all() for each in networks.values())


def test_landmarks_move_brows_half_of_the_way_and_nostrils_not_at_all() -> None:
    points = 100.0 * np.random.default_rng(0).random((478, 2))
    curves = np.zeros((MOUTH + 1, 6, 2))
    moved = mesh_lenses(points, curves + 1.0) - mesh_lenses(points, curves)
    share = {"brow": 0.5, "nost": 1.0}
    for row, name in enumerate((*NAMES, "mouth")):
        assert np.allclose(moved[row], share.get(name[:4], 0.0)), name


def test_rectangles_become_lenses() -> None:
    placement = Placement.at(np.array([[100.0, 100.0], [200.0, 100.0]]))
    curves = np.stack([usual_lenses()[name] for name in (*NAMES, "mouth")])
    drawn = drawn_lenses({"lips": np.array([110.0, 190.0, 190.0, 220.0])}, placement, curves)
    assert np.allclose(drawn[ROW["lips"], :2], [[-40.0, 105.0], [40.0, 105.0]])
    assert float(height(drawn[ROW["lips"]])) == pytest.approx(30.0, abs=1.0)
    assert np.array_equal(drawn[ROW["eye_left"]], curves[ROW["eye_left"]])


def test_curves_of_another_shape_are_refused() -> None:
    with pytest.raises(FormatError, match="lack a sound 'neutral'"):
        curve_calibration(Performer(curves={"neutral": np.zeros((3, 3))}).curves)


def test_a_second_look_is_kept_only_where_it_is_clearer(film: list[Picture]) -> None:
    stepper = SnakeCapture()
    seen = stepper.step(film[0])
    assert seen is not None
    assert stepper._look_again(seen, film[0]) is seen
    unclear = replace(seen, contrast=0.5 * seen.contrast, lenses=seen.lenses + 9.0)
    again = stepper._look_again(unclear, film[0])
    assert again.recovered
    assert np.allclose(again.lenses, seen.lenses)
    assert stepper._look_again(unclear, GREY) is unclear
