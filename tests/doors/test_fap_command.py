"""``.fap`` at the door: takes that drive characters, takes that are written, takes that are bad."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pygltflib
import pytest
from terminal import error_line, mien

from mien.formats.takes.fap import read_take, simple_take, write_take
from mien.formats.takes.table import read_table
from mien.vocabulary.fap import expressions, visemes


@pytest.fixture
def joy(tmp_path: Path) -> Path:
    """A second of a face that brightens and says "ah"."""
    rise = np.sin(np.linspace(0.0, np.pi, 25))[:, None]
    values = rise * expressions()["joy"] + rise**4 * visemes()["a"]
    path = tmp_path / "joy.fap"
    write_take(path, simple_take(np.arange(25) / 25.0, values))
    return path


def test_a_fap_file_drives_a_character(joy: Path, tmp_path: Path) -> None:
    done = mien("animate", joy, "-c", "toy", "-o", "joy.glb", "--json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["frames"] == 25
    found = pygltflib.GLTF2().load_binary(str(tmp_path / "joy.glb"))
    assert len(found.animations) == 1


def test_faps_can_be_the_morph_targets(joy: Path, tmp_path: Path) -> None:
    done = mien("animate", joy, "-c", "man", "--mapping", "fap", "-o", "m.glb", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    found = pygltflib.GLTF2().load_binary(str(tmp_path / "m.glb"))
    names = {name for mesh in found.meshes for name in (mesh.extras or {}).get("targetNames", ())}
    assert {"open_jaw", "raise_l_cornerlip_o", "slide_t_l_eyelid"} <= names
    assert (
        mien(
            *("animate", joy, "-c", "man", "--mapping", "fap", "--no-filter", "-o", "m.csv"),
            cwd=tmp_path,
        ).returncode
        == 0
    )
    table = read_table(tmp_path / "m.csv")
    jaw = table.weights[:, table.names.index("open_jaw")] * 1800
    np.testing.assert_allclose(jaw, read_take(joy).values[:, 2], atol=1e-6)


def test_a_preview_shows_faps(joy: Path, tmp_path: Path) -> None:
    done = mien("animate", joy, "-c", "woman", "--mapping", "fap", "-o", "w.mp4", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert (tmp_path / "w.mp4").stat().st_size > 1000


def test_a_take_becomes_a_fap_file_and_arkit_and_back(joy: Path, tmp_path: Path) -> None:
    assert mien("capture", joy, "-o", "same.fap", cwd=tmp_path).returncode == 0
    np.testing.assert_array_equal(read_take(tmp_path / "same.fap").values, read_take(joy).values)
    assert mien("capture", joy, "-o", "joy.csv", cwd=tmp_path).returncode == 0
    assert mien("capture", "joy.csv", "-o", "back.fap", cwd=tmp_path).returncode == 0
    before, after = read_take(joy).values, read_take(tmp_path / "back.fap").values
    assert abs(after[12] - before[12]).mean() < 0.5 * abs(before[12]).mean()


def test_bad_files_are_told_in_one_line(joy: Path, tmp_path: Path) -> None:
    lines = joy.read_text().split("\n")
    huge = lines[0].rsplit(" ", 1)[0] + " 2000000000\n"
    bad = {
        "text": ("dear diary", "not a .fap file"),
        "counts": ("\n".join([*lines[:2], lines[2] + " 5"]), "67 values for a mask of 66"),
    }
    for name, (text, told) in bad.items():
        path = tmp_path / f"{name}.fap"
        path.write_text(text)
        said = error_line(mien("animate", path, "-c", "man", "-o", "x.glb", cwd=tmp_path))
        assert told in said
        assert str(path) in said
        assert not (tmp_path / "x.glb").exists()
    jumps = [huge, *(line + "\n" for line in lines[1:21])]
    jumps[-1] = "900" + jumps[-1][jumps[-1].index(" ") :]
    path = tmp_path / "jumps.fap"
    path.write_bytes("".join(jumps).replace("\n", "\r\n").encode())
    done = mien("capture", path, "-o", "j.mien", "--json", cwd=tmp_path)
    assert json.loads(done.stdout)["frames"] == 10
    assert json.loads(done.stdout)["seconds"] == 36.0


def test_a_fap_file_is_no_recording(joy: Path, tmp_path: Path) -> None:
    said = error_line(mien("animate", joy, "--start", "1", "-o", "out", cwd=tmp_path))
    assert "captured before" in said
