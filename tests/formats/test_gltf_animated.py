"""A take in the file a character came from: its own targets move, all else is as it was."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from faces import toy_curves
from foreign import issues, needs_validator
from gltf_reader import Reader
from guests import DATA, document, edited, needs_characters, write_guest
from mien.face.animate import Poser
from mien.face.character import Character
from mien.face.pieces import split
from mien.face.targets import targets
from mien.formats.gltf.animated import write_animated
from mien.formats.save import save
from mien.rig.importer import import_character


@pytest.fixture(scope="module")
def guest(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Character]:
    path, points = write_guest(tmp_path_factory.mktemp("guest"))

    def dressed(told: Any) -> None:
        told["extras"] = {"mine": [1, {"deep": "ä"}]}
        told["materials"][0]["extensions"] = {"ACME_skin": {"sss": 0.3}}

    edited(path, dressed)
    return path, import_character(path, points=points).character


def test_the_rest_of_the_file_is_untouched(guest: tuple[Path, Character], tmp_path: Path) -> None:
    path, character = guest
    assert character.origin is not None
    (tmp_path / "idle.glb").write_bytes(character.origin.glb)
    idle = {"name": "idle", "channels": [], "samplers": []}
    edited(tmp_path / "idle.glb", lambda told: told.update(animations=[idle]))
    origin = replace(character.origin, glb=(tmp_path / "idle.glb").read_bytes())
    character = replace(character, origin=origin)
    write_animated(tmp_path / "a.glb", character, toy_curves(character))
    before, after = document(path), document(tmp_path / "a.glb")
    for kind in ("nodes", "meshes", "materials", "scenes", "extras", "asset"):
        assert json.dumps(after[kind]) == json.dumps(before[kind]), kind
    for kind in ("accessors", "bufferViews"):
        assert after[kind][: len(before[kind])] == before[kind]
    assert [animation["name"] for animation in after["animations"]] == ["take", "idle"]


def test_targets_head_and_eyes_move_as_in_the_preview(
    guest: tuple[Path, Character], tmp_path: Path
) -> None:
    _, character = guest
    curves = replace(toy_curves(character), translation=np.zeros((9, 3)))
    save(curves, tmp_path / "a.glb", character)
    reader = Reader(tmp_path / "a.glb")
    poser = Poser(character.face, targets(character, curves.names))
    assert character.origin is not None
    for frame in (0, 4, 8):
        posed = reader.world(frame)
        wanted = poser.at(curves, frame)
        places = np.concatenate([posed[name] for name in sorted(posed)])
        low, high = places.min(axis=0), places.max(axis=0)
        offset = 1e3 * character.origin.centre
        assert np.allclose(low, (wanted + offset).min(axis=0), atol=1.5)
        assert np.allclose(high, (wanted + offset).max(axis=0), atol=1.5)


def test_weights_go_to_the_targets_of_their_names(
    guest: tuple[Path, Character], tmp_path: Path
) -> None:
    _, character = guest
    curves = toy_curves(character)
    write_animated(tmp_path / "a.glb", character, curves)
    reader = Reader(tmp_path / "a.glb")
    names = reader.target_names()
    values = reader.channels()["face", "weights"][1].reshape(len(curves), -1)
    for column, name in enumerate(curves.names):
        assert np.allclose(values[:, names.index(name)], curves.weights[:, column], atol=1e-6)
    assert curves.names == split(character).names


@needs_validator
def test_the_khronos_validator_is_content(tmp_path: Path) -> None:
    path, points = write_guest(tmp_path)
    character = import_character(path, points=points).character
    write_animated(tmp_path / "a.glb", character, toy_curves(character))
    assert [issue for issue in issues(tmp_path / "a.glb") if issue["severity"] < 2] == []


@needs_characters
def test_a_file_that_rests_at_other_weights_is_driven_from_zero(tmp_path: Path) -> None:
    pytest.importorskip("mediapipe")
    source = DATA / "facecap" / "facecap_plain.glb"
    character = import_character(source, units="face").character
    curves = toy_curves(character)
    write_animated(tmp_path / "a.glb", character, curves)
    told = document(tmp_path / "a.glb")
    take = told["animations"][0]
    paths = {(c["target"]["node"], c["target"]["path"]) for c in take["channels"]}
    assert sum(path == "weights" for _, path in paths) == 1
    # Both eyes turn, and one node that carries the whole head.
    assert sum(path == "rotation" for _, path in paths) == 3
    assert len(told["animations"]) == 5


def test_pictures_nobody_can_show_keep_nobody_out(tmp_path: Path) -> None:
    """Blender refuses a file that requires KTX2; with the pictures only named it opens the rest."""
    path, points = write_guest(tmp_path)

    def change(told: Any) -> None:
        told["extensionsUsed"] = [*told.get("extensionsUsed", []), "KHR_texture_basisu"]
        told["extensionsRequired"] = ["KHR_texture_basisu"]

    character = import_character(edited(path, change), points=points).character
    write_animated(tmp_path / "a.glb", character, toy_curves(character))
    told = document(tmp_path / "a.glb")
    assert "extensionsRequired" not in told
    assert "KHR_texture_basisu" in told["extensionsUsed"]
