"""Laws of posing."""

from __future__ import annotations

import numpy as np
import pytest

from mien.face.animate import Poser
from mien.face.character import Character
from mien.face.pieces import split
from mien.numeric.rotation import from_vector


@pytest.fixture
def poser(toy_face: Character) -> Poser:
    return Poser(toy_face.face, split(toy_face))


def test_zero_weights_give_the_neutral_bit_for_bit(poser: Poser) -> None:
    posed = poser.pose(np.zeros(len(poser.names)), np.eye(3), np.zeros(3), np.zeros((2, 2)))
    assert np.array_equal(posed, poser.face.vertices)


def test_morphing_is_the_weighted_sum_of_key_models(toy_face: Character) -> None:
    weights = np.array([0.3, 1.2, 0.7, -0.1])
    posed = Poser(toy_face.face, toy_face.keys).morph(weights)
    np.testing.assert_allclose(posed, toy_face.surface(weights), atol=1e-5)


def test_pieces_at_one_weight_give_the_whole_key_model(toy_face: Character) -> None:
    pieces = split(toy_face)
    for key in range(len(toy_face.keys.names)):
        posed = Poser(toy_face.face, pieces).morph((pieces.key == key).astype(float))
        whole = toy_face.face.vertices + toy_face.keys.displacements[key]
        np.testing.assert_allclose(posed, whole, atol=1e-5)


def test_the_head_turns_about_its_pivot_and_the_body_only_travels_along(poser: Poser) -> None:
    face = poser.face
    rotation, shift = from_vector(np.array([0.1, -0.4, 0.2])), np.array([3.0, -2.0, 1.0])
    posed = poser.pose(np.zeros(len(poser.names)), rotation, shift)
    bust = face.part("bust")
    still = face.vertices[bust.first : bust.last]
    np.testing.assert_allclose(posed[bust.first : bust.last], still + shift, atol=1e-12)
    pivot = face.pivots["head"]
    expected = (face.vertices[: bust.first] - pivot) @ rotation.T + pivot + shift
    np.testing.assert_allclose(posed[: bust.first], expected, atol=1e-9)


def test_an_eye_looks_where_the_gaze_says(poser: Poser) -> None:
    """Left eye to the subject's left (+x), right eye up (+y); each keeps its centre."""
    face, gaze = poser.face, np.array([[0.3, 0.0], [0.0, 0.2]])
    posed = poser.pose(np.zeros(len(poser.names)), gaze=gaze)
    for name, along in (("eye_left", (np.sin(0.3), 0, np.cos(0.3))),
                        ("eye_right", (0, np.sin(0.2), np.cos(0.2)))):  # fmt: skip
        part, pivot = face.part(name), face.pivots[name]
        ball = face.vertices[part.first : part.last] - pivot
        front = int(np.argmax(ball[:, 2]))
        turned = posed[part.first : part.last] - pivot
        radius = np.linalg.norm(ball[front])
        # The front vertex stands a little off the axis.
        np.testing.assert_allclose(turned[front] / radius, along, atol=0.2)
        np.testing.assert_allclose(np.linalg.norm(turned, axis=1), np.linalg.norm(ball, axis=1))
    skin = face.part("skin")
    assert np.array_equal(posed[skin.first : skin.last], face.vertices[skin.first : skin.last])
