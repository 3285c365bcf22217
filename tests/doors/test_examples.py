"""The numbered examples, run as they stand."""

from __future__ import annotations

import runpy
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from terminal import needs_landmarks

EXAMPLES = Path(__file__).parents[2] / "examples"
ALONE = {
    "03_weights_from_anywhere.py": "toy.csv",
    "04_markers_to_surface.py": "surface.glb",
    "05_make_a_character.py": "somebody.glb",
    "07_stream_and_hear.py": "jaw_open",
    "09_add_a_mapper.py": "poses",
}
"""Examples that need nothing, and what they tell or write."""
WITH_TAKE = ("01_video_to_character.py", "02_read_a_performance.py", "06_film_a_character.py")
IN_BLENDER = "08_glb_to_fbx.py"
"""Tried by tests/formats/test_fbx.py."""


Run = Callable[..., str]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Run:
    def run(name: str, *arguments: object) -> str:
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sys, "argv", [name, *map(str, arguments)])
        runpy.run_path(str(EXAMPLES / name), run_name="__main__")
        return capsys.readouterr().out

    return run


def test_every_example_is_numbered_short_and_run_here() -> None:
    found = {path.name: path.read_text() for path in EXAMPLES.glob("*.py")}
    assert found.keys() == {*ALONE, *WITH_TAKE, IN_BLENDER}
    for number, name in enumerate(sorted(found), start=1):
        assert name.startswith(f"{number:02d}_")
        assert len(found[name].splitlines()) < 100


@pytest.mark.parametrize("name", ALONE)
def test_it_runs(name: str, run: Run, tmp_path: Path) -> None:
    said, expected = run(name), ALONE[name]
    assert expected in said
    if "." in expected:
        assert (tmp_path / expected).stat().st_size > 1000


@needs_landmarks
def test_a_video_drives_a_character(run: Run, take: Path, tmp_path: Path) -> None:
    assert "12 frames" in run(WITH_TAKE[0], take, "toy")
    assert {path.name for path in tmp_path.iterdir()} == {"toy.glb", "toy.mp4"}


@needs_landmarks
def test_a_performance_is_read(run: Run, captured: Path) -> None:
    said = run(WITH_TAKE[1], captured)
    assert "left eye shuts at [0.2" in said
    assert "right eye shuts at []" in said


def test_a_character_is_filmed(run: Run, tmp_path: Path) -> None:
    run(WITH_TAKE[2], "toy", "grin.mp4", "smile")
    assert (tmp_path / "grin.mp4").stat().st_size > 1000
