"""The landmark networks take our people for people, and read what they do."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

import mien
from mien.face.animate import Poser
from mien.face.character import Character
from mien.view.camera import Camera
from mien.view.renderer import Renderer
from mien.vocabulary.landmarks import EYE_CORNERS, LOWER_LID, UPPER_LID

face_mesh = pytest.importorskip(
    "mediapipe.python.solutions.face_mesh", reason="needs the extra 'landmarks'"
)

Array = NDArray[np.float64]
Look = Callable[[Array, float], Array | None]
YAWS = (0.0, np.radians(25.0))


@pytest.fixture(scope="module")
def mesh():
    with face_mesh.FaceMesh(static_image_mode=True, refine_landmarks=True) as found:
        yield found


@pytest.fixture(params=["man", "woman", "monkey"], scope="module")
def character(request) -> Character:
    return mien.load_character(request.param)


@pytest.fixture(scope="module")
def look(mesh, character: Character) -> Look:
    """Landmarks (478, 2) in pixels of the character at some weights, or None where no face is
    seen; every picture by itself."""
    poser, renderer = Poser(character.face, character.keys), Renderer(character.face)

    def see(weights: Array, yaw: float) -> Array | None:
        camera = Camera(yaw=yaw, size=(640, 480))
        found = mesh.process(renderer.render(poser.morph(weights), camera)).multi_face_landmarks
        if not found:
            return None
        return np.array([(p.x * 640.0, p.y * 480.0) for p in found[0].landmark])

    return see


def shown(character: Character, key: str) -> Array:
    return (np.array(character.keys.names) == key).astype(float)


@pytest.mark.parametrize("yaw", YAWS, ids=["front", "25 degrees"])
def test_every_key_model_is_taken_for_a_face(character, look, yaw):
    refused = [key for key in character.keys.names if look(shown(character, key), yaw) is None]
    assert refused == []


@pytest.mark.parametrize("yaw", YAWS, ids=["front", "25 degrees"])
def test_a_smile_widens_the_mouth(character, look, yaw):
    def width(points: Array) -> float:
        return float(np.linalg.norm(points[291] - points[61]))

    rest = look(np.zeros(len(character.keys.names)), yaw)
    assert width(look(shown(character, "smile"), yaw)) > 1.04 * width(rest)


@pytest.mark.parametrize("side", [0, 1], ids=["left", "right"])
def test_a_blink_closes_the_eye_of_its_side(character, look, side):
    def openings(points: Array) -> Array:
        height = [
            np.mean([points[d, 1] - points[u, 1] for u, d in zip(up, down, strict=True)])
            for up, down in zip(UPPER_LID, LOWER_LID, strict=True)
        ]
        width = [np.linalg.norm(points[outer] - points[inner]) for outer, inner in EYE_CORNERS]
        return np.array(height) / width

    rest = openings(look(np.zeros(len(character.keys.names)), 0.0))
    key = ("blink_left", "blink_right")[side]
    now = openings(look(shown(character, key), 0.0)) / rest
    assert now[side] < 0.6
    assert now[1 - side] > now[side] + 0.3
