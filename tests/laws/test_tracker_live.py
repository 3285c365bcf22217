"""The tracker, one frame at a time, against the whole take."""

from __future__ import annotations

from importlib.resources import files
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mediapipe", reason="the extra 'landmarks' is not installed")

from mien.capture import landmarks
from mien.capture.detector import follow
from mien.capture.neutral import ground
from mien.capture.settings import CaptureSettings
from mien.capture.stepping import LEARNING, TrackerStepper
from mien.capture.tracker.capture import Faces, follow_take, tracker
from mien.capture.tracker.crop import Crop, cut
from mien.capture.tracker.meet import generic_person
from mien.capture.tracker.perform import perform
from mien.capture.tracker.trust import Trust
from mien.face.library import generic_face
from mien.formats.pictures.sources import open_source
from mien.performance.frame import Frame


@pytest.fixture(scope="module")
def film() -> list[Frame]:
    """The start of the clip that is shipped."""
    return list(islice(open_source(Path(str(files("mien") / "data" / "sample.mp4"))), 38))


def test_stepped_frames_are_those_of_the_whole_take(film: list[Frame]) -> None:
    stepper = TrackerStepper()
    stepped = [stepper.step(frame) for frame in film]
    first = next(i for i, performance in enumerate(stepped) if performance is not None)
    assert film[first].time - film[0].time >= LEARNING > film[first - 1].time - film[0].time

    faces = Faces()
    track, base = follow(film, beside=faces.look), ground(generic_face())
    known = landmarks.calibrate(
        follow(film[: first + 1]), base, neutral=(film[0].time, film[first].time)
    )
    somebody, rest = generic_person(known, track.size), slice(0, first + 1)
    done = follow_take(track, faces, somebody, rest, Trust(meeting=False))
    whole = perform(track, done.found, done.met, known, landmarks.perform(track, known, base, ""))
    for number in range(first, len(film)):
        now = stepped[number]
        assert now is not None
        for name in ("neutral", "sigma"):
            np.testing.assert_allclose(getattr(now, name), getattr(whole, name), atol=1e-6)
        for name in ("motion", "rotation", "translation", "gaze", "unseen"):
            theirs = getattr(whole, name)[number]
            np.testing.assert_allclose(getattr(now, name)[0], theirs, atol=1e-6)
        assert 0.0 < now.confidence[0] <= 1.0
    assert len(stepper.trace.wire)
    stepper.learn()
    assert stepper.step(film[0]) is None
    stepper.close()


def test_a_face_that_goes_keeps_its_last_look_and_is_met_where_it_comes_back(
    film: list[Frame],
) -> None:
    stepper = TrackerStepper()
    last = [stepper.step(frame) for frame in film][-1]
    gone = stepper.step(Frame(np.full_like(film[0].image, 128), 9.0))
    assert last is not None
    assert gone is not None
    assert gone.lost[0]
    assert stepper.trace.lost
    np.testing.assert_array_equal(gone.motion, last.motion)
    back = stepper.step(Frame(film[-1].image, 9.1))
    assert back is not None
    assert not back.lost[0]
    assert stepper.trace.notes == ("recovered",)
    stepper.close()


def test_a_take_whose_skin_is_not_found_again_is_left_to_the_landmarks(
    film: list[Frame], monkeypatch: pytest.MonkeyPatch
) -> None:
    random, short = np.random.default_rng(0), film[:8]
    base = ground(generic_face())
    track = follow(short)
    known = landmarks.calibrate(track, base)

    def noise(_: Faces, index: int) -> Crop:
        shape = short[index].image.shape
        return cut(random.integers(0, 256, shape).astype(np.uint8), track.points[index])

    monkeypatch.setattr(Faces, "__getitem__", noise)
    said: list[str] = []
    left = tracker(short, CaptureSettings(notice=said.append), "noise")
    assert len(said) == 1
    assert "landmarks" in said[0]
    plain = landmarks.perform(track, known, base, "noise")
    np.testing.assert_allclose(left.motion, plain.motion, atol=1e-6)
