"""``mien animate`` and ``mien capture`` on marker takes, alone and through a databank."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pygltflib
import pytest
from terminal import error_line, mien

from mien.face.databank import Databank, databank
from mien.face.library import generic_face
from mien.formats.databank_file import write_databank
from mien.formats.takes.mien_file import read_performance
from mien.formats.takes.table import read_table
from takes import JIG, WORN, act, c3d

SHAPES = ("jawOpen", "mouthSmileLeft", "mouthSmileRight", "browInnerUp", "mouthPucker")


@pytest.fixture(scope="module")
def take(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A second and a quarter of a performer in markers, two of them swapped for a while."""
    acted, *_ = act(150)
    first, second = (acted.labels.index(label) for label in ("LipLow", "LLipLow"))
    places = acted.places.copy()
    places[100:130, [first, second]] = places[100:130, [second, first]]
    path = tmp_path_factory.mktemp("markers") / "take.c3d"
    return c3d(replace(acted, places=places), path)


@pytest.fixture(scope="module")
def bank(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("bank") / "bank.npz"
    write_databank(path, _bank())
    return path


def _bank() -> Databank:
    return databank(replace(generic_face(), name="her", examples=SHAPES))


def test_markers_drive_characters(take: Path, tmp_path: Path) -> None:
    done = mien("animate", take, "-c", "man", "-c", "monkey", "-o", "out", "--json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    told = json.loads(done.stdout)
    assert (told["frames"], told["lost_frames"]) == (150, 0)
    assert told["markers"]["points"]["8.3"] == "LMouth"
    assert told["markers"]["mended"] == [
        {"kind": "swap", "labels": ["LLipLow", "LipLow"], "first": 100, "last": 129}
    ]
    assert {path.name for path in tmp_path.joinpath("out").iterdir()} == {
        "man.glb", "monkey.glb", "preview.mp4",
    }  # fmt: skip


def test_markers_are_captured_and_described(take: Path, tmp_path: Path) -> None:
    done = mien("capture", take, "-o", "t.mien", "--neutral", "0-0.3", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines()[0].endswith(
        "28 feature points, at rest 0.00 to 0.30 s, mended: 1 swap"
    )
    performance = read_performance(tmp_path / "t.mien")
    assert len(performance) == 150
    assert not performance.unseen.any()


def test_a_surface_lands_on_the_databanks_person(take: Path, bank: Path, tmp_path: Path) -> None:
    done = mien(
        "animate", take, "--databank", bank, "-o", "out", "--no-preview", "--json", cwd=tmp_path
    )
    assert (done.returncode, done.stderr) == (0, "")
    glb = pygltflib.GLTF2().load_binary(str(tmp_path / "out/her.glb"))
    names = next(mesh.extras["targetNames"] for mesh in glb.meshes if mesh.extras)
    assert names[: len(SHAPES)] == list(SHAPES)
    assert all(name.startswith("rest_") for name in names[len(SHAPES) :])
    assert glb.animations[0].channels


def test_a_surface_lands_on_the_performer(take: Path, bank: Path, tmp_path: Path) -> None:
    own = 1.05 * _bank().face.vertices
    lines = [f"v {x:.5f} {y:.5f} {z:.5f}" for x, y, z in own]
    lines += [f"f {a} {b} {c}" for a, b, c in _bank().face.triangles + 1]
    (tmp_path / "performer.obj").write_text("\n".join(lines))
    options = ("--databank", bank, "-c", "performer.obj")
    done = mien("animate", take, *options, "-o", "take.glb", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines()[-1] == "take.glb"
    (tmp_path / "small.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    said = error_line(
        mien("animate", take, "--databank", bank, "-c", "small.obj", "-o", "s.glb", cwd=tmp_path)
    )
    assert "build both from one mesh" in said


def test_a_databank_tells_characters_more(take: Path, bank: Path, tmp_path: Path) -> None:
    for name, options in (("bare", ()), ("told", ("--databank", bank))):
        done = mien("animate", take, "-c", "man", *options, "-o", f"{name}.csv", cwd=tmp_path)
        assert (done.returncode, done.stderr) == (0, "")
    bare, told = (read_table(tmp_path / f"{name}.csv") for name in ("bare", "told"))
    assert bare.names == told.names
    assert np.abs(bare.weights - told.weights).max() > 0.01


def test_bad_takes_have_one_line(take: Path, tmp_path: Path) -> None:
    acted, *_ = act(60)
    c3d(acted, tmp_path / "unit.c3d", units=None)
    said = error_line(mien("animate", "unit.c3d", "-c", "man", cwd=tmp_path))
    assert "unit.c3d: it names no unit; say --units, here likely --units mm" in said
    assert mien("capture", "unit.c3d", "--units", "mm", cwd=tmp_path).returncode == 0
    strange = replace(acted, labels=tuple(f"M{i}" for i in range(len(acted.labels))))
    c3d(strange, tmp_path / "strange.c3d")
    assert "--labels" in error_line(mien("capture", "strange.c3d", cwd=tmp_path))
    said = error_line(mien("capture", take, "--mirror", cwd=tmp_path))
    assert "--mirror" in said
    said = error_line(mien("animate", take, "--databank", "none.npz", cwd=tmp_path))
    assert "none.npz" in said
    assert sorted(path.suffix for path in tmp_path.iterdir()) == [".c3d", ".c3d", ".mien"]


def test_users_may_say_which_marker_is_which(tmp_path: Path) -> None:
    acted, *_ = act(60)
    c3d(replace(acted, labels=tuple(f"M{i}" for i in range(len(acted.labels)))), tmp_path / "m.c3d")
    roles = [f"M{i},{fdp}" for i, fdp in enumerate(WORN.values())]
    roles += [f"M{len(WORN) + i},jig" for i in range(len(JIG))]
    (tmp_path / "roles.csv").write_text("# label, point\n" + "\n".join(roles))
    done = mien("capture", "m.c3d", "--labels", "roles.csv", "-o", "m.mien", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert set(read_performance(tmp_path / "m.mien").points) == set(WORN.values())
