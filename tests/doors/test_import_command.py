"""'mien character import' and 'check', and animating what was imported."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from terminal import mien

from actors import shown
from guests import PICKS, SHAPES, guest, write_guest
from mien.formats.takes.mien_file import write_performance


@pytest.fixture(scope="module")
def here(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("import")
    write_guest(folder)
    weights = np.zeros((6, len(SHAPES)))
    weights[2:, SHAPES.index("eyeBlinkLeft")] = 1.0
    write_performance(shown(guest(), weights), folder / "wink.mien")
    return folder


def test_import_then_animate(here: Path) -> None:
    done = mien(
        *("character", "import", "guest.glb", "--points", "points.toml", "-o", "pal"), cwd=here
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert "9 of 9 shapes act" in done.stdout
    assert done.stdout.splitlines()[-1] == "pal.character"
    done = mien("animate", "wink.mien", "-c", "pal.character", "-o", "pal.glb", cwd=here)
    assert (done.returncode, done.stderr) == (0, "")
    content = (here / "pal.glb").read_bytes()
    assert content[:4] == b"glTF"
    assert b'"name":"take"' in content
    assert (here / "guest.glb").stat().st_size < len(content)


def test_a_folder_with_blanks_is_taken_in_beside_itself(here: Path) -> None:
    """-o NAME where a folder of that name is the character's own."""
    character, folder = guest(SHAPES[:2]), here / "my fox"
    folder.mkdir()
    faces = "".join("f {} {} {}\n".format(*row) for row in character.face.triangles + 1)
    one, two = (character.keys[name] for name in SHAPES[:2])
    shapes = {"base": np.zeros(3), "one": one, "two": two}
    for name, moved in shapes.items():
        places = "".join("v {} {} {}\n".format(*row) for row in character.face.vertices + moved)
        (folder / f"{name}.obj").write_text(places + faces)
    lines = [f'"{fdp}" = {character.face.point(fdp).tolist()}' for fdp in PICKS]
    (here / "my points.toml").write_text("[points]\n" + "\n".join(lines) + "\n")
    done = mien(
        *("character", "import", "my fox", "--points", "my points.toml", "--units", "mm"),
        *("-o", "my fox"),
        cwd=here,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines()[-1] == "my fox.character"
    assert sorted(file.name for file in folder.iterdir()) == ["base.obj", "one.obj", "two.obj"]


def test_whoever_animates_is_sent_where_they_can_say_the_unit(here: Path) -> None:
    done = mien("animate", "wink.mien", "-c", "my fox", "-o", "x.glb", cwd=here)
    assert done.returncode == 1
    assert "mien character import" in done.stderr


def test_check_tells_what_each_shape_does(here: Path) -> None:
    done = mien(
        *("character", "check", "guest.glb", "--points", "points.toml", "--json"),
        *("-o", "points.png"),
        cwd=here,
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    shapes = {shape["name"]: shape for shape in told["shapes"]}
    assert shapes["eyeBlinkLeft"]["side"] == "left"
    assert shapes["eyeBlinkLeft"]["region"] == "eyes"
    assert shapes["jawOpen"]["like"] == "jawOpen"
    assert told["blinks"] == ["eyeBlinkLeft", "eyeBlinkRight"]
    assert told["face"]["facing"] == "+z"
    assert told["doubts"] == []
    with Image.open(here / "points.png") as picture:
        assert picture.width > 1000
    plain = mien("character", "check", "guest.glb", "--points", "points.toml", cwd=here)
    assert "eyeBlinkLeft" in plain.stdout


def test_errors_are_one_line_and_leave_nothing(here: Path, tmp_path: Path) -> None:
    (tmp_path / "bad.glb").write_bytes(b"glTF")
    (tmp_path / "bad.toml").write_text("[points]\n")
    good = str(here / "guest.glb")
    for arguments, told in (
        (("check", "bad.glb"), "ends inside its header"),
        (("import", good, "--points", "bad.toml"), "no [points]"),
        (("import", good, "-o", "x.glb"), ".character"),
        (("import", "bad.toml"), "characters come as"),
    ):
        done = mien("character", *arguments, cwd=tmp_path)
        assert (done.returncode, done.stdout) == (1, ""), arguments
        assert told in done.stderr
        assert done.stderr.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["bad.glb", "bad.toml"]
