"""The curve capture on takes that are hard: nothing is invented where nothing is seen."""

from __future__ import annotations

import os
from contextlib import suppress
from itertools import islice
from pathlib import Path

import cv2
import numpy as np
import pytest

from mien.capture import CAPTURES, CaptureSettings
from mien.capture.snakes.curves.features import ROW
from mien.capture.snakes.head.patch import HEIGHT
from mien.capture.snakes.seen import Seen
from mien.capture.snakes.stepper import SnakeCapture
from mien.errors import NoFaceError
from mien.face.library import load_character
from mien.formats.pictures.sources import open_source
from mien.performance.frame import Frame
from mien.view.camera import Camera
from mien.view.renderer import Renderer

DATA = Path(os.environ.get("MIEN_TEST_DATA", "absent")) / "video"
recorded = pytest.mark.skipif(not DATA.is_dir(), reason="MIEN_TEST_DATA names no recorded takes")


def followed(name: str, first: int, last: int) -> list[Seen | None]:
    """What is seen from the frame ``first`` on, before ``last``."""
    stepper = SnakeCapture()
    frames = islice(open_source(DATA / name), first, last)
    return [stepper.step(frame.image) for frame in frames]


@recorded
def test_a_face_that_leaves_is_lost() -> None:
    seen = followed("vfr.mov", 52, 92)
    assert all(each is not None for each in seen[:20])
    assert all(each is None for each in seen[21:])


@recorded
def test_a_mouth_behind_a_hand_is_marked() -> None:
    seen = followed("hand.mp4", 40, 115)
    # From frame 115 on half of the mouth shows beside the fingers, and is found.
    covered = [each is None or bool(each.lost[ROW["lips"]]) for each in seen[55:75]]
    bare = [each is None or bool(each.lost[ROW["lips"]]) for each in seen[:12]]
    assert np.mean(covered) > 0.8
    assert np.mean(bare) < 0.2


@recorded
@pytest.mark.parametrize("name", ["d9.mp4", "dark.mp4"])
def test_curves_stay_on_the_face_under_glasses_beard_and_blur(name: str) -> None:
    seen = [each for each in followed(name, 0, 24) if each is not None]
    assert len(seen) > 20
    for each in seen:
        assert np.isfinite(each.lenses).all()
        assert np.abs(each.lenses).max() < HEIGHT


@pytest.mark.parametrize("size", [(64, 48), (96, 72)])
def test_a_tiny_picture_gives_a_face_or_a_plain_refusal(size: tuple[int, int]) -> None:
    man = load_character("man")
    picture = Renderer(man.face).render(man.face.vertices, Camera(size=(256, 256)))
    tiny = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA), dtype=np.uint8)
    frames = [Frame(tiny, i / 30.0) for i in range(3)]
    with suppress(NoFaceError):
        performance = CAPTURES["snakes"](iter(frames), CaptureSettings(), "tiny")
        assert np.isfinite(performance.motion).all()


def test_a_face_that_turns_grey_keeps_honest() -> None:
    man = load_character("man")
    picture = Renderer(man.face).render(man.face.vertices, Camera(size=(256, 256)))
    grey = np.repeat(cv2.cvtColor(picture, cv2.COLOR_RGB2GRAY)[..., None], 3, axis=2)
    frames = [Frame(image, i / 30.0) for i, image in enumerate([picture] * 3 + [grey] * 3)]
    performance = CAPTURES["snakes"](iter(frames), CaptureSettings(), "grey")
    assert np.isfinite(performance.motion).all()
    assert performance.confidence[3:].max() <= performance.confidence[:3].min()
