"""Characters that nobody made for us: what their unnamed shapes do is found by measurement."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mien
from actors import built_in, shown
from guests import DATA, needs_characters
from mien.rig.importer import Import, import_character

pytestmark = needs_characters

POINTS = Path(__file__).parents[1] / "points"
ANIMALS = ("fox", "koala", "triceratops")


@pytest.fixture(params=ANIMALS, scope="module")
def animal(request: pytest.FixtureRequest) -> Import:
    name = request.param
    folder = DATA / "animals" / name / "obj"
    return import_character(folder, points=POINTS / f"{name}.toml", units="mm")


def test_every_one_sided_shape_has_its_twin(animal: Import) -> None:
    sides = [act.side for act in animal.acts]
    assert sides.count("left") == sides.count("right") == 4
    assert len(animal.character.blinks) == 2
    assert len(animal.character.examples) == 11
    assert all(act.confidence > 0.5 for act in animal.acts)


def test_sides_are_where_vertices_move(animal: Import) -> None:
    character = animal.character
    for act in animal.acts:
        if act.side == "both":
            continue
        effort = (character.keys[act.name].astype(float) ** 2).sum(axis=1)
        middle = float((effort * character.face.vertices[:, 0]).sum() / effort.sum())
        assert np.sign(middle) == (1.0 if act.side == "left" else -1.0), act.name


def test_a_left_wink_of_a_person_is_the_animals_left(animal: Import) -> None:
    person = built_in("man")
    weights = np.zeros((1, len(person.examples)))
    weights[0, person.examples.index("blink_left")] = 1.0
    lids = {"lid_left": np.ones(1), "lid_right": np.zeros(1)}
    curves = mien.animate(shown(person, weights, scalars=lids), animal.character, smooth=False)
    winks = {
        act.side: curves.weights[0, curves.names.index(act.name)]
        for act in animal.acts
        if act.name in animal.character.blinks
    }
    assert winks["left"] > 0.8
    assert winks["right"] < 0.1


@pytest.mark.parametrize(
    ("file", "units", "shapes"),
    [
        ("facecap/facecap_plain.glb", "face", 51),
        ("humans/ict_facekit_parts.glb", "cm", 55),
        ("humans/makehuman_caucasian_male_units.glb", "dm", 30),
        ("vrm/Godette_vrm_v4.vrm", None, 8),
        ("vrm/godette_as_vrm1.vrm", None, 8),
    ],
)
def test_faces_that_are_human_enough_are_found_by_looking(
    file: str, units: str | None, shapes: int
) -> None:
    pytest.importorskip("mediapipe")
    found = import_character(DATA / file, units=units)
    acts = {act.name: act for act in found.acts}
    left, right = (
        next(
            act for act in acts.values() if act.name in found.character.blinks and act.side == side
        )
        for side in ("left", "right")
    )
    assert "eft" in left.name or left.name.endswith("_L")
    assert "ight" in right.name or right.name.endswith("_R")
    assert 0.75 < left.shuts[0] < 1.5
    assert len(found.character.examples) >= shapes - 1
