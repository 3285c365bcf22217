"""The landmark capture, one frame at a time: shut lids that are learnt, and faces in view."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from importlib.resources import files
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mediapipe", reason="the extra 'landmarks' is not installed")

from mien.capture.detector import Detector, follow
from mien.capture.known import known_or_learnt, landmark_section
from mien.capture.landmarks import calibrate, perform, with_shut
from mien.capture.neutral import ground
from mien.capture.settings import CaptureSettings
from mien.capture.stepping import LandmarkStepper, meet
from mien.capture.track import ROW, LandmarkTrack
from mien.errors import InputError
from mien.face.library import generic_face
from mien.formats.pictures.sources import open_source
from mien.performance.frame import Frame
from mien.performance.performer import Performer
from mien.vocabulary.landmarks import LOWER_LID, UPPER_LID


@pytest.fixture(scope="module")
def film() -> list[Frame]:
    """The start of the clip that is shipped."""
    return list(islice(open_source(Path(str(files("mien") / "data" / "sample.mp4"))), 40))


@pytest.fixture
def stepper() -> Iterator[LandmarkStepper]:
    stepper = LandmarkStepper()
    yield stepper
    stepper.close()


def shut(track: LandmarkTrack, share: float) -> LandmarkTrack:
    """The same face with its upper lids brought down on the lower ones by a ``share``."""
    points = track.points.copy()
    for uppers, lowers in zip(UPPER_LID, LOWER_LID, strict=True):
        for upper, lower in zip(uppers, lowers, strict=True):
            up, down = points[:, ROW[upper], 1], points[:, ROW[lower], 1]
            points[:, ROW[upper], 1] = up + share * (down - up)
    return replace(track, points=points)


def test_lids_that_were_shut_are_shut_from_then_on(film: list[Frame]) -> None:
    face, base = follow(film), ground(generic_face())
    known = with_shut(calibrate(face, base), shut(face, 0.8), base)
    for share, closure in ((0.8, 1.0), (0.0, 0.0)):
        seen = perform(shut(face, share), known, base, "a test")
        for lid in ("lid_left", "lid_right"):
            assert np.median(seen.scalars[lid]) == pytest.approx(closure, abs=0.25)
    with pytest.raises(InputError, match="not shut"):
        with_shut(known, face, base)


def test_a_performer_is_met_again(film: list[Frame], stepper: LandmarkStepper) -> None:
    for frame in film:
        stepper.step(frame)
    known = stepper.known
    assert known is not None
    friend = meet("landmarks", Performer(landmarks=landmark_section(known)))
    assert isinstance(friend, LandmarkStepper)
    assert friend.known is not None
    np.testing.assert_array_equal(friend.known.model, known.model)
    assert friend.step(film[0]) is not None
    friend.close()


def test_a_whole_take_is_read_against_a_performer_that_is_known(film: list[Frame]) -> None:
    face, base = follow(film), ground(generic_face())
    known = calibrate(face, base, focal=777.0)
    friend = CaptureSettings(performer=Performer(landmarks=landmark_section(known)))
    assert known_or_learnt(face, base, friend).focal == 777.0
    assert known_or_learnt(face, base, CaptureSettings(focal=555.0)).focal == 555.0


def test_the_networks_say_in_our_thread_what_they_say_in_theirs(film: list[Frame]) -> None:
    from mediapipe.python.solutions.face_mesh import FaceMesh

    blank = np.zeros_like(film[0].image)
    pictures = [blank, *(frame.image for frame in film[:6]), blank, film[0].image]
    scale = np.array([blank.shape[1], blank.shape[0], blank.shape[1]], dtype=np.float32)
    with FaceMesh(max_num_faces=1, refine_landmarks=True) as theirs, Detector() as ours:
        for picture in pictures:
            found = theirs.process(picture).multi_face_landmarks
            seen = ours.landmarks(picture)
            assert (seen is None) == (not found)
            if seen is not None:
                places = np.array([(p.x, p.y, p.z) for p in found[0].landmark], dtype=np.float32)
                np.testing.assert_array_equal(seen, places * scale)


def test_faces_in_view_are_counted_and_one_is_followed(
    film: list[Frame], stepper: LandmarkStepper
) -> None:
    image = film[0].image
    two = np.ascontiguousarray(np.concatenate([image, image], axis=1))
    counted = []
    for picture, time in ((image, 0.0), (two, 0.5), (two, 1.5), (two, 1.6)):
        stepper.step(Frame(picture, time))
        stepper.look_around()
        counted.append(stepper.trace.faces)
    assert counted == [1, 1, 1, 2], "counted once a second, and told from the next picture on"
