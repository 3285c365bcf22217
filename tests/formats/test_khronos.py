"""The Khronos glTF validator finds nothing to say about our files."""

from __future__ import annotations

from pathlib import Path

import pytest

from faces import toy_curves
from foreign import issues, needs_validator
from mien.face.character import Character
from mien.face.library import CHARACTERS, load_character
from mien.formats.gltf.glb import write_glb

pytestmark = needs_validator


def test_a_toy_take_is_valid(toy_face: Character, tmp_path: Path) -> None:
    write_glb(tmp_path / "a.glb", toy_face, toy_curves(toy_face))
    assert issues(tmp_path / "a.glb") == []


@pytest.mark.parametrize("name", CHARACTERS)
def test_the_built_in_characters_are_valid(name: str, tmp_path: Path) -> None:
    character = load_character(name)
    for curves in (None, toy_curves(character)):
        write_glb(tmp_path / "a.glb", character, curves)
        assert issues(tmp_path / "a.glb") == []


def test_the_validator_does_find_faults(toy_face: Character, tmp_path: Path) -> None:
    path = tmp_path / "a.glb"
    write_glb(path, toy_face)
    path.write_bytes(path.read_bytes().replace(b'"VEC3"', b'"VEC2"', 1))
    assert any(issue["severity"] == 0 for issue in issues(path))
