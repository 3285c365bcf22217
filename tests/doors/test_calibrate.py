"""``mien calibrate`` and what the other commands make of its file."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from terminal import mien

from mien.formats.takes.mien_file import read_performance


def test_a_performer_is_learnt_once_and_used_again(take: Path, tmp_path: Path) -> None:
    done = mien(
        "calibrate", take, "-o", "me.performer", "--pose", "rest=0-0.1", "--json", cwd=tmp_path
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert "curves" in told["learnt_by"]
    assert "snakes/rest" in told["poses"]
    for name in ("one", "two"):
        again = mien(
            "capture",
            take,
            "--capture",
            "snakes",
            "--performer",
            "me.performer",
            "-o",
            f"{name}.mien",
            cwd=tmp_path,
        )
        assert again.returncode == 0, again.stderr
    one, two = (read_performance(tmp_path / f"{name}.mien") for name in ("one", "two"))
    assert np.array_equal(one.motion, two.motion)
    assert len(one.points) == 20


def test_files_that_are_no_performer_are_told_in_one_line(take: Path, tmp_path: Path) -> None:
    (tmp_path / "me.performer").write_bytes(b"nothing of the kind")
    done = mien("capture", take, "--performer", "me.performer", "-o", "x.mien", cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "me.performer" in done.stderr
    assert not (tmp_path / "x.mien").exists()


def test_endings_and_poses_are_checked(take: Path, tmp_path: Path) -> None:
    assert mien("calibrate", take, "-o", "me.txt", cwd=tmp_path).returncode == 1
    wrong = mien("calibrate", take, "-o", "me.performer", "--pose", "smile", cwd=tmp_path)
    assert wrong.returncode == 2
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("option", "value"),
    [("--pose", "smile=90-91"), ("--shut", "0-0.1"), ("--features", "f.csv")],
)
def test_what_the_takes_do_not_show_is_told_in_one_line(
    take: Path, tmp_path: Path, option: str, value: str
) -> None:
    (tmp_path / "f.csv").write_text("0,lips,9000,10,9020,20\n")
    done = mien("calibrate", take, "-o", "me.performer", option, value, cwd=tmp_path)
    assert done.returncode == 1
    assert done.stderr.startswith(f"mien: {option}")
    assert done.stderr.count("\n") == 1
    assert not (tmp_path / "me.performer").exists()
