"""The real Blender imports what we write: names, values and times."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from faces import toy_curves
from foreign import blender, needs_blender
from mien.face.character import Character
from mien.formats.gltf.glb import write_glb

pytestmark = needs_blender


@pytest.fixture(scope="module")
def imported(toy_face: Character, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    path = tmp_path_factory.mktemp("blender") / "toy.glb"
    write_glb(path, toy_face, toy_curves(toy_face))
    return blender(path)


def test_shape_keys_bear_our_names(toy_face: Character, imported: dict[str, Any]) -> None:
    names = toy_curves(toy_face).names
    assert imported["face"]["shape_keys"] == ["Basis", *names]
    assert imported["face"]["parent"] == imported["eye_left"]["parent"] == "head"


def test_weights_and_times_come_through(toy_face: Character, imported: dict[str, Any]) -> None:
    curves = toy_curves(toy_face)
    for column, name in enumerate(curves.names):
        key = imported["face"]["weights"][f'key_blocks["{name}"].value#0']
        np.testing.assert_allclose(key["value"], curves.weights[:, column], atol=1e-4)
        np.testing.assert_allclose(key["time"], curves.time, atol=1e-3)


def test_head_and_eyes_turn_at_our_times(toy_face: Character, imported: dict[str, Any]) -> None:
    curves = toy_curves(toy_face)
    for name in ("head", "eye_left", "eye_right"):
        turn = imported[name]["motion"]["rotation_quaternion#0"]
        np.testing.assert_allclose(turn["time"], curves.time, atol=1e-3)
    travel = imported[toy_face.name]["motion"]
    # Blender's z is our y.
    height = curves.translation[:, 1] / 1e3
    np.testing.assert_allclose(travel["location#2"]["value"], height, atol=1e-5)
