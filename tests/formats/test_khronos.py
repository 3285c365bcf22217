"""The Khronos glTF validator finds nothing to say about our files.

Skipped where Node or the validator is missing: it is looked for in MIEN_GLTF_VALIDATOR (a folder
with node_modules), or where .ci/tools.sh puts it.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

from faces import toy_curves
from mien.face.character import Character
from mien.face.library import CHARACTERS, load_character
from mien.formats.glb import write_glb

HERE = Path(__file__).parent
VALIDATOR = Path(os.environ.get("MIEN_GLTF_VALIDATOR") or HERE.parents[1] / ".tools" / "validator")
NODE = shutil.which("node")

pytestmark = pytest.mark.skipif(
    NODE is None or not (VALIDATOR / "node_modules" / "gltf-validator").exists(),
    reason="no glTF validator: run .ci/tools.sh (needs Node), or set MIEN_GLTF_VALIDATOR",
)


def issues(path: Path) -> list[dict[str, Any]]:
    run = subprocess.run(
        [str(NODE), HERE / "validate_gltf.js", path],
        env=os.environ | {"NODE_PATH": str(VALIDATOR / "node_modules")},
        capture_output=True,
        text=True,
        check=True,
        timeout=60,
    )
    found: list[dict[str, Any]] = json.loads(run.stdout)["messages"]
    return found


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
