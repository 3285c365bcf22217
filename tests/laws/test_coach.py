"""The coach: what counts as a face, what it is kept for, and what it replaces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the extra 'studio' is not installed")

from actors import FACE_ON, built_in, shown
from mien.live.studio.coach import Coach, in_words, key_poses, known_faces
from mien.live.studio.messages import Hold, Learnt
from mien.performance.performance import Performance
from mien.performance.performer import Performer

NAMES = built_in("woman").examples


def face(name: str, level: float = 1.0) -> Performance:
    levels = np.zeros((1, len(NAMES)))
    levels[0, NAMES.index(name)] = level
    return shown(built_in("woman"), levels, unseen=FACE_ON)


def held(
    coach: Coach, performance: Performance, pose: str, shake: float = 0.0, who: str = ""
) -> Learnt:
    coach.ask(Hold("face", who, pose), {pose: 1.0})
    random = np.random.default_rng(1)
    for number in range(100):
        motion = performance.motion + random.normal(0.0, shake, performance.motion.shape)
        frame = replace(performance, time=np.array([number / 30]), motion=motion)
        if coach.see(number / 30, frame):
            return coach.judge("landmarks")
        assert 0.0 <= coach.share < 1.0
    raise AssertionError("the coach waits for ever")


def test_a_face_that_is_held_is_kept_as_it_was() -> None:
    coach, smile = Coach(), face("smile")
    assert held(coach, smile, "smile").quality == "good"
    np.testing.assert_allclose(coach.faces[0].motion, smile.motion[0])
    assert coach.faces[0].pose == {"smile": 1.0}
    assert coach.task is None
    assert coach.shown()[0].far > 1.0


def test_rest_is_no_face_and_trembling_is_told() -> None:
    coach = Coach()
    assert held(coach, face("smile", 0.02), "smile").quality == "refused"
    assert coach.faces == []
    assert held(coach, face("surprise"), "surprise", shake=8.0).quality == "shaky"


def test_the_newest_counts_of_those_that_look_alike_or_stand_for_the_same() -> None:
    coach = Coach()
    held(coach, face("smile"), "smile")
    held(coach, face("surprise"), "surprise")
    held(coach, face("smile", 1.4), "smile")
    assert [each.pose for each in coach.faces] == [{"surprise": 1.0}, {"smile": 1.0}]
    held(coach, face("smile", 1.4), "fear")
    assert [each.pose for each in coach.faces] == [{"surprise": 1.0}, {"fear": 1.0}]
    held(coach, face("smile", 1.4), "smile", who="man")
    assert len(coach.faces) == 3


def test_nobody_waits_for_a_face_that_does_not_come() -> None:
    coach = Coach()
    coach.ask(Hold("neutral", "", ""), {})
    assert not coach.see(0.0, None)
    assert coach.see(60.0, None)
    assert coach.judge("landmarks").quality == "refused"


def test_key_poses_go_both_ways_between_page_and_calibration() -> None:
    coach = Coach()
    held(coach, face("smile"), "smile")
    held(coach, face("surprise"), "surprise", who="man")
    poses = key_poses(coach.faces)
    assert list(poses) == ["landmarks/smile"]
    (met,) = known_faces(Performer(poses=poses))
    assert (met.capture, met.character, met.pose) == ("landmarks", "", {"smile": 1.0})
    np.testing.assert_array_equal(met.motion, coach.faces[0].motion)
    kept = Performer(poses=poses, held=tuple(coach.faces))
    assert known_faces(kept) == coach.faces


def test_poses_in_words() -> None:
    assert in_words({"smile": 1.0}) == "smile"
    assert in_words({"a": 0.2, "b": 0.7}) == "b 0.7, a 0.2"
    assert in_words(dict.fromkeys("abcde", 0.5)).endswith("and 2 more")
