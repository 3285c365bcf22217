"""The house keeps its plan: imports run downwards, rooms that must not meet do not."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
PACKAGE = ROOT / "src" / "mien"

EXTRAS = {"mediapipe": {"capture"}, "cv2": {"view", "capture", "formats"}}
"""Modules of optional extras, and the rooms that may ask for them."""


def imported(path: Path) -> set[str]:
    """Top names of all modules a file imports, wherever in it."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            found.add(node.module.partition(".")[0])
    return found


def test_imports_run_downwards_only() -> None:
    lint = Path(sys.executable).with_name("lint-imports")
    if not lint.exists():
        pytest.skip("import-linter is not installed")
    done = subprocess.run(
        [lint, "--no-logo", "--no-cache"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stdout


@pytest.mark.parametrize("extra", EXTRAS)
def test_optional_libraries_are_asked_for_in_few_rooms(extra: str) -> None:
    users = {
        path.relative_to(PACKAGE).parts[0]
        for path in PACKAGE.rglob("*.py")
        if extra in imported(path)
    }
    assert users <= EXTRAS[extra] | {"cli"}


def test_mathematics_knows_no_files_and_no_screen() -> None:
    for path in (PACKAGE / "numeric").glob("*.py"):
        assert not imported(path) & {"pathlib", "os", "io", "av", "PIL", "rich", "json"}, path.name


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda path: path.stem)
def test_a_module_stays_one_thing(path: Path) -> None:
    assert len(path.read_text("utf-8").splitlines()) <= 450
