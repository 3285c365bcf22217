"""The commands that only tell."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path

from PIL import Image
from terminal import MIEN, mien


def test_help_names_every_command(tmp_path: Path) -> None:
    done = mien("--help", cwd=tmp_path)
    assert done.returncode == 0
    for command in ("animate", "capture", "character", "demo", "doctor"):
        assert command in done.stdout
    assert "--gain" in mien("animate", "--help", cwd=tmp_path).stdout


def test_characters_are_listed(tmp_path: Path) -> None:
    done = mien("character", "list", "--json", cwd=tmp_path)
    told = json.loads(done.stdout)["characters"]
    assert [character["name"] for character in told] == ["man", "woman", "monkey", "toy"]
    assert all("smile" in character["key_models"] for character in told)
    assert mien("character", "list", cwd=tmp_path).stdout.count("\n") == 4
    assert "jaw_open" in mien("character", "list", "man", cwd=tmp_path).stdout


def test_a_character_is_shown_on_a_sheet(tmp_path: Path) -> None:
    for output, sheet in (("sheets", "sheets/toy.png"), ("one.png", "one.png")):
        done = mien("character", "show", "toy", "-o", output, cwd=tmp_path)
        assert (done.stdout, done.stderr) == (f"{sheet}\n", "")
        with Image.open(tmp_path / sheet) as picture:
            assert picture.width > 1000


def test_a_character_goes_into_another_program(tmp_path: Path) -> None:
    done = mien("character", "export", "toy", "-o", "toy.glb", cwd=tmp_path)
    assert (done.stdout, done.stderr) == ("toy.glb\n", "")
    assert (tmp_path / "toy.glb").read_bytes()[:4] == b"glTF"
    # Small enough for a web page: all key models, stored sparsely.
    assert (tmp_path / "toy.glb").stat().st_size < 3_000_000
    wrong = mien("character", "export", "toy", "-o", "toy.fbx", cwd=tmp_path)
    assert (wrong.returncode, wrong.stdout) == (1, "")
    assert wrong.stderr == "mien: -o toy.fbx: export writes .glb files\n"


def test_doctor_tells_what_works(tmp_path: Path) -> None:
    done = mien("doctor", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    checks = {check["name"]: check["works"] for check in told["checks"]}
    assert checks["video"]
    assert checks["characters"]
    assert checks["landmarks"] == (told["packages"]["mediapipe"] is not None)
    assert not list(tmp_path.iterdir())


def test_a_reader_who_leaves_early_is_no_error(tmp_path: Path) -> None:
    running = subprocess.Popen(
        [MIEN, "character", "list"], cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert running.stdout is not None
    assert running.stderr is not None
    running.stdout.close()
    assert running.stderr.read() == b""
    assert running.wait(timeout=60) == 0
