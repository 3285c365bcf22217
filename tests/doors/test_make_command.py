"""mien character make, wires and suggest, as a user runs them."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from terminal import mien

from mien.face.library import load_character
from mien.formats.gltf.pack import opened
from mien.formats.gltf.read import read_gltf

PICKS = ("3.1", "3.3", "3.7", "3.11", "4.3", "8.3", "9.3", "8.1", "2.2", "2.3", "8.2", "2.1")


@pytest.fixture(scope="module")
def neutral(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The man's face as an OBJ file without any shape, and twelve points on it."""
    folder = tmp_path_factory.mktemp("neutral")
    face = load_character("man").face
    lines = [f"v {x:.4f} {y:.4f} {z:.4f}\n" for x, y, z in face.vertices]
    for part in face.parts:
        if part.follows != "body":
            lines.append(f"o {part.name}\n")
            lines += [f"f {a} {b} {c}\n" for a, b, c in part.triangles + 1]
    (folder / "head.obj").write_text("".join(lines))
    rows = [f'"{fdp}" = {face.point(fdp).round(3).tolist()}\n' for fdp in PICKS]
    (folder / "points.toml").write_text("[points]\n" + "".join(rows))
    return folder / "head.obj", folder / "points.toml"


def test_a_bare_head_becomes_a_character_that_acts(
    neutral: tuple[Path, Path], captured: Path, tmp_path: Path
) -> None:
    head, points = neutral
    done = mien(
        *("character", "make", head, "--points", points, "--units", "mm"),
        *("-o", "made.npz", "--json"),
        cwd=tmp_path,
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert len(told["shapes"]) == 52
    character = load_character(tmp_path / "made.npz")
    jaw = character.face.points.at(character.keys["jawOpen"])
    assert jaw[character.face.points.index(["2.1"])[0], 1] < -5.0
    acted = mien("animate", captured, "-c", "made.npz", "-o", "made.glb", cwd=tmp_path)
    assert acted.returncode == 0, acted.stderr
    assert (tmp_path / "made.glb").stat().st_size > 10_000


def test_an_artist_s_file_keeps_what_it_holds_and_teaches_the_rest(tmp_path: Path) -> None:
    man = load_character("man")
    assert mien("character", "export", "man", "-o", "man.glb", cwd=tmp_path).returncode == 0
    rows = [f'"{fdp}" = {(man.face.point(fdp) / 1000).tolist()}\n' for fdp in PICKS]
    (tmp_path / "points.toml").write_text("[points]\n" + "".join(rows))
    (tmp_path / "map.toml").write_text('[shapes]\n"jaw_open" = "jawOpen"\n')
    done = mien(
        *("character", "make", "man.glb", "--points", "points.toml", "--map", "map.toml"),
        *("-o", "made.glb", "--json"),
        cwd=tmp_path,
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert "jawOpen" in told["kept"]
    assert any(name.startswith("mouthSmile") for name in told["poses"]["smile"])
    before, after = read_gltf(tmp_path / "man.glb"), read_gltf(tmp_path / "made.glb")
    shapes = {shape.name: after.dense(shape) for shape in after.shapes}
    assert set(shapes) >= {"mouthSmileLeft", *(shape.name for shape in before.shapes)}
    assert np.abs(shapes["jawOpen"] - shapes["jaw_open"]).max() < 1e-6
    old, new = (opened((tmp_path / f"{name}.glb").read_bytes())[0] for name in ("man", "made"))
    for kind in ("materials", "textures", "images"):
        assert new[kind] == old[kind]


def test_make_tells_what_is_wrong(neutral: tuple[Path, Path], tmp_path: Path) -> None:
    head, points = neutral
    for arguments, word in (
        ((head, "--points", points, "--units", "mm", "-o", "x.fbx"), "-o x.fbx"),
        ((head, "--points", points, "-o", "x.npz"), "--units"),
    ):
        done = mien("character", "make", *arguments, cwd=tmp_path)
        assert done.returncode == 1
        assert word in done.stderr
        assert done.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())


def test_a_key_model_is_edited_by_its_wires(tmp_path: Path) -> None:
    assert mien("character", "wires", "toy", "-o", "toy.toml", cwd=tmp_path).returncode == 0
    edited = "[smile]\n" + '"8.3" = [9.0, 12.0, 0.0]\n'
    (tmp_path / "edit.toml").write_text(edited)
    done = mien("character", "wires", "toy", "--wires", "edit.toml", "-o", "new.npz", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    before, after = load_character("toy"), load_character(tmp_path / "new.npz")
    assert np.abs(after.keys["smile"] - before.keys["smile"]).max() > 1.0
    (tmp_path / "edit.toml").write_text('[grin]\n"8.3" = [0, 0, 0]\n')
    wrong = mien("character", "wires", "toy", "--wires", "edit.toml", cwd=tmp_path)
    assert wrong.returncode == 1
    assert "grin" in wrong.stderr


def test_suggest_names_key_models_and_draws_them(captured: Path, tmp_path: Path) -> None:
    done = mien(
        "character", "suggest", "toy", "--takes", captured, "-o", "out", "--json", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert len(told["suggestions"]) == 3
    assert all(s["after"] <= s["before"] for s in told["suggestions"])
    assert (tmp_path / told["file"]).exists()


def test_sliders_and_own_examples_reach_the_mapper(captured: Path, tmp_path: Path) -> None:
    (tmp_path / "own.toml").write_text("[[example]]\nseconds = 0.1\npose = { smile = 1.0 }\n")
    done = mien(
        *("animate", captured, "-c", "woman", "--mapping", "wires", "--mouth", "1.3"),
        *("--own", "own.toml", "--own-range", "-f", "csv", "-o", "out", "--no-preview"),
        cwd=tmp_path,
    )
    assert done.returncode == 0, done.stderr
