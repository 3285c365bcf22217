"""The curve capture, one frame at a time, against the whole take."""

from __future__ import annotations

from importlib.resources import files
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from mien.capture.settings import CaptureSettings
from mien.capture.snakes.capture import follow
from mien.capture.snakes.curves.features import MOUTH
from mien.capture.snakes.curves.lens import height
from mien.capture.snakes.points import depths
from mien.capture.snakes.reading import calibrate, perform
from mien.capture.snakes.rehearsal import drawn
from mien.capture.snakes.stepper import SnakeCapture
from mien.capture.stepping import LEARNING, STEPPERS, SnakeStepper
from mien.face.library import generic_face
from mien.formats.pictures.sources import open_source
from mien.performance.frame import Frame

FRAMES = 36


@pytest.fixture(scope="module")
def film() -> list[Frame]:
    """The start of the clip that is shipped."""
    return list(islice(open_source(Path(str(files("mien") / "data" / "sample.mp4"))), FRAMES))


def test_stepped_frames_are_those_of_the_whole_take(film: list[Frame]) -> None:
    track = follow(film[:12], SnakeCapture(), CaptureSettings())
    known = calibrate(track, depths(generic_face()))
    whole, stepper = perform(track, known, "take"), SnakeStepper(known)
    for number, frame in enumerate(film[:12]):
        now = stepper.step(frame)
        assert now is not None
        np.testing.assert_allclose(now.motion[0], whole.motion[number], atol=1e-6)
        np.testing.assert_allclose(now.rotation[0], whole.rotation[number], atol=1e-6)
        for name, values in whole.scalars.items():
            np.testing.assert_allclose(now.scalars[name][0], values[number], atol=1e-6)
    assert np.ptp(whole.motion, axis=0).max() > 0.1


def test_a_performer_is_learnt_in_the_first_second_and_anew(film: list[Frame]) -> None:
    stepper = STEPPERS["snakes"]()
    for _ in range(2):
        told = [stepper.step(frame) is not None for frame in film]
        first = told.index(True)
        assert all(told[first:])
        assert film[first - 1].time - film[0].time < LEARNING <= film[first].time - film[0].time
        stepper.learn()
    stepper.close()


def test_a_face_that_goes_keeps_its_last_look_and_is_told(film: list[Frame]) -> None:
    stepper = SnakeStepper()
    last = [stepper.step(frame) for frame in film][-1]
    gone = stepper.step(Frame(np.full_like(film[0].image, 128), 9.0))
    assert last is not None
    assert gone is not None
    assert gone.lost[0]
    assert gone.confidence[0] == 0.0
    assert stepper.trace.lost
    np.testing.assert_array_equal(gone.motion, last.motion)


def test_the_face_of_the_rehearsal_is_followed_with_its_mouth_open() -> None:
    capture = SnakeCapture()
    seen = [capture.step(drawn()) for _ in range(2)]
    for each in seen:
        assert each is not None
        assert not each.lost.any()
        assert height(each.lenses[MOUTH]) > 5.0
