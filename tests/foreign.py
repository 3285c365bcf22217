"""Readers that are not ours: the Khronos glTF validator and the real Blender.

They are looked for where .ci/tools.sh puts them, or where MIEN_GLTF_VALIDATOR (a folder with
node_modules) and MIEN_BPY_PYTHON (a Python that has bpy) say; tests skip where they are missing.
"""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).parent / "formats"
TOOLS = HERE.parents[1] / ".tools"
VALIDATOR = Path(os.environ.get("MIEN_GLTF_VALIDATOR") or TOOLS / "validator")
BLENDER = Path(os.environ.get("MIEN_BPY_PYTHON") or TOOLS / "bpy" / "bin" / "python")
NODE = shutil.which("node")

needs_validator = pytest.mark.skipif(
    NODE is None or not (VALIDATOR / "node_modules" / "gltf-validator").exists(),
    reason="no glTF validator: run .ci/tools.sh (needs Node), or set MIEN_GLTF_VALIDATOR",
)
needs_blender = pytest.mark.skipif(
    not BLENDER.exists(),
    reason="no Blender: run .ci/tools.sh, or set MIEN_BPY_PYTHON to a Python that has bpy",
)


def issues(path: Path) -> list[dict[str, Any]]:
    """All the validator has to say about ``path``."""
    run = subprocess.run(
        [str(NODE), HERE / "validate_gltf.js", path],
        env=os.environ | {"NODE_PATH": str(VALIDATOR / "node_modules")},
        capture_output=True,
        text=True,
        check=True,
        timeout=120,
    )
    found: list[dict[str, Any]] = json.loads(run.stdout)["messages"]
    return found


def blender(path: Path) -> dict[str, Any]:
    """What Blender has after importing ``path``: objects with shape keys, weights and motion."""
    run = subprocess.run(
        [BLENDER, HERE / "blender_import.py", path],
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    lines = [line for line in run.stdout.splitlines() if line.startswith("IMPORTED ")]
    assert lines, run.stdout[-2000:] + run.stderr[-2000:]
    found: dict[str, Any] = json.loads(lines[0].removeprefix("IMPORTED "))
    return found
