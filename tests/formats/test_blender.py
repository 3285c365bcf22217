"""The real Blender imports what we write: names, values and times.

Skipped where no Python with bpy is found: in MIEN_BPY_PYTHON, or where .ci/tools.sh puts one.
"""

from __future__ import annotations

import json
import os
import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from faces import toy_curves
from mien.face.character import Character
from mien.formats.glb import write_glb

HERE = Path(__file__).parent
BLENDER = Path(
    os.environ.get("MIEN_BPY_PYTHON") or HERE.parents[1] / ".tools" / "bpy" / "bin" / "python"
)

pytestmark = pytest.mark.skipif(
    not BLENDER.exists(),
    reason="no Blender: run .ci/tools.sh, or set MIEN_BPY_PYTHON to a Python that has bpy",
)


@pytest.fixture(scope="module")
def imported(toy_face: Character, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    path = tmp_path_factory.mktemp("blender") / "toy.glb"
    write_glb(path, toy_face, toy_curves(toy_face))
    script = HERE / "blender_import.py"
    run = subprocess.run(
        [BLENDER, script, path], capture_output=True, text=True, check=False, timeout=120
    )
    lines = [line for line in run.stdout.splitlines() if line.startswith("IMPORTED ")]
    assert lines, run.stdout[-2000:] + run.stderr[-2000:]
    found: dict[str, Any] = json.loads(lines[0].removeprefix("IMPORTED "))
    return found


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
    travel = imported["head"]["motion"]
    # Blender's z is our y.
    height = (curves.translation[:, 1] + toy_face.face.pivots["head"][1]) / 1e3
    np.testing.assert_allclose(travel["location#2"]["value"], height, atol=1e-5)
