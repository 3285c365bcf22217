"""What a performance tells outright, and where painted eyes look, reaches key models."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import mien
from mien.capture.shapes import motion_from_shapes
from mien.face.character import Character
from mien.mapping.beside import beside
from mien.performance.acted import acted
from mien.performance.curves import Curves
from mien.performance.performance import Performance
from mien.vocabulary.arkit import names


@pytest.fixture(scope="module")
def woman() -> Character:
    return mien.load_character("woman")


def performance(**scalars: list[float]) -> Performance:
    return acted(
        (),
        np.zeros((0, 3)),
        np.zeros((3, 0, 3)),
        sigma=np.zeros(0),
        scalars={name: np.array(values) for name, values in scalars.items()},
    )


def curves(*names: str, weight: float = 0.0) -> Curves:
    frames = 3
    return Curves(
        character="woman",
        names=names,
        time=np.arange(frames) / 30.0,
        weights=np.full((frames, len(names)), weight),
        rotation=np.tile(np.eye(3), (frames, 1, 1)),
        translation=np.zeros((frames, 3)),
        gaze=np.zeros((frames, 2, 2)),
        lost=np.zeros(frames, bool),
        residual=np.zeros(frames),
    )


def test_a_tongue_that_is_out_is_out(woman: Character) -> None:
    told = beside(curves("smile"), performance(tongue_out=[0.0, np.nan, 0.7]), woman)
    assert told.names == ("smile", "tongue_out")
    np.testing.assert_allclose(told.weights[:, 1], [0.0, 0.0, 0.7])


def test_what_is_not_measured_drives_nothing(woman: Character) -> None:
    assert beside(curves("smile"), performance(), woman).names == ("smile",)


def test_somebody_s_own_words_answer(woman: Character) -> None:
    keys = replace(woman.keys, names=tuple(f"shape {i}" for i in range(len(woman.keys.names))))
    theirs = replace(
        woman, keys=keys, speaks={"arkit": {"cheekPuff": ("shape 1", "shape 2")}}, looks={}
    )
    plain = curves("shape 1", weight=0.5)
    told = beside(plain, performance(cheek_puff=[0.2, 0.9, 2.0]), theirs)
    assert told.names == ("shape 1", "shape 2")
    np.testing.assert_allclose(told.weights, [[0.5, 0.2], [0.9, 0.9], [1.0, 1.0]])


def test_painted_eyes_look_where_the_performer_looks(woman: Character) -> None:
    painted = replace(woman, looks={"left": "look_left", "down": "look_down"})
    gaze = np.broadcast_to(np.radians([17.5, -35.0]), (3, 2, 2))
    told = beside(replace(curves("smile"), gaze=gaze), performance(), painted)
    assert told.names == ("smile", "look_left", "look_down")
    np.testing.assert_allclose(told.weights[0], [0.0, 0.5, 1.0])


def test_what_a_phone_says_of_the_tongue_comes_through() -> None:
    spoken = names()
    shapes = np.zeros((3, len(spoken)))
    shapes[1, spoken.index("tongueOut")] = 0.8
    phone = replace(performance(), vocabulary="arkit", shapes=shapes)
    moved = motion_from_shapes(phone, mien.load_character("generic"))
    np.testing.assert_allclose(moved.scalars["tongue_out"], [0.0, 0.8, 0.0])
    toy = mien.animate(phone, "toy", smooth=False)
    np.testing.assert_allclose(toy.weights[:, toy.names.index("tongue_out")], [0, 0.8, 0])
