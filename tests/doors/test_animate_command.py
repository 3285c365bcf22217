"""``mien animate`` and ``mien capture``: what is asked for is there, and reads back."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pygltflib
from terminal import FRAMES, WINK, error_line, mien, needs_landmarks

from mien.formats.pictures.video import open_video
from mien.formats.takes.mien_file import read_performance
from mien.formats.takes.table import read_table

pytestmark = needs_landmarks


def test_a_take_drives_characters_into_a_folder(take: Path, tmp_path: Path) -> None:
    done = mien("animate", take, "-c", "man", "-c", "toy", "-o", "new/out", "--json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    told = json.loads(done.stdout)
    assert told["frames"] == FRAMES
    assert told["lost_frames"] == 0
    assert [Path(path).name for path in told["files"]] == ["man.glb", "toy.glb", "preview.mp4"]
    assert len(list(open_video(tmp_path / "new/out/preview.mp4"))) == FRAMES
    assert all((tmp_path / path).stat().st_size > 1000 for path in told["files"])
    assert {path.name for path in tmp_path.joinpath("new/out").iterdir()} == {
        Path(path).name for path in told["files"]
    }


def test_one_result_may_be_a_folder_of_meshes(captured: Path, tmp_path: Path) -> None:
    done = mien("animate", captured, "-c", "man", "-o", "m.obj", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert len(list(tmp_path.glob("m/*.obj"))) == FRAMES


def test_results_are_listed_for_people(captured: Path, tmp_path: Path) -> None:
    done = mien("animate", captured, "-c", "man", "--no-preview", cwd=tmp_path)
    assert done.stderr == ""
    assert done.stdout.splitlines() == [
        f"{captured}: {FRAMES} frames, {(FRAMES - 1) / 30:.2f} s, a face in all of them",
        "out/woman/man.glb",
    ]
    assert [path.name for path in (tmp_path / "out/woman").iterdir()] == ["man.glb"]


def test_a_files_ending_chooses_the_format(captured: Path, tmp_path: Path) -> None:
    assert mien("animate", captured, "-c", "man", "-o", "m.csv", cwd=tmp_path).returncode == 0
    assert mien("animate", captured, "-c", "man", "-o", "m.glb", cwd=tmp_path).returncode == 0
    table = read_table(tmp_path / "m.csv")
    assert len(table) == FRAMES
    animation = pygltflib.GLTF2().load_binary(str(tmp_path / "m.glb")).animations[0]
    assert animation.channels
    said = error_line(mien("animate", captured, "-o", "all.glb", cwd=tmp_path))
    assert "choose one with -c" in said
    assert sorted(path.name for path in tmp_path.iterdir()) == ["m.csv", "m.glb"]


def test_options_change_what_they_name(captured: Path, tmp_path: Path) -> None:
    def table(*options: str) -> tuple[np.ndarray, np.ndarray]:
        done = mien("animate", captured, "-c", "man", "-o", "m.csv", *options, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        curves = read_table(tmp_path / "m.csv")
        return curves.weights, curves.translation

    weights, travel = table()
    more, still = table("--no-head", "--gain", "1.5")
    assert np.abs(travel).max() > 0
    assert not still.any()
    assert np.abs(more).sum() > 1.1 * np.abs(weights).sum()
    assert (
        np.abs(np.diff(table("--no-filter")[0], axis=0)).sum()
        > np.abs(np.diff(weights, axis=0)).sum()
    )


def test_a_cut_take_is_as_long_as_the_cut(take: Path, tmp_path: Path) -> None:
    done = mien("capture", take, "--start", 0.1, "--end", 0.3, "-o", "c.mien", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    performance = read_performance(tmp_path / "c.mien")
    assert len(performance) == 6
    assert performance.time[0] == 0.0


def test_mirror_exchanges_the_sides(take: Path, captured: Path, tmp_path: Path) -> None:
    assert mien("capture", take, "--mirror", "-o", "m.mien", cwd=tmp_path).returncode == 0

    def left_more_shut(path: Path) -> float:
        lids = read_performance(path).scalars
        return float((lids["lid_left"] - lids["lid_right"])[WINK].mean())

    assert left_more_shut(captured) > 0.3
    assert left_more_shut(tmp_path / "m.mien") < -0.3


def test_the_demo_needs_nothing_but_mien(tmp_path: Path) -> None:
    done = mien("demo", "-c", "toy", "--no-preview", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.splitlines()[-1] == "out/demo/toy.glb"
    assert (tmp_path / "out/demo/toy.glb").stat().st_size > 1000
