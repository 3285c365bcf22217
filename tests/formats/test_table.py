"""The table of weights: read back, it is the same curves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mien.errors import FormatError
from mien.formats.takes.table import FIXED, read_table, write_table
from mien.numeric.rotation import from_vector
from mien.performance.curves import Curves


def make(frames: int = 6) -> Curves:
    random = np.random.default_rng(3)
    return Curves(
        character="man",
        names=("jaw_open", "smile, wide"),
        time=np.cumsum(random.uniform(0.01, 0.05, frames)),
        weights=random.normal(size=(frames, 2)),
        rotation=from_vector(random.normal(size=(frames, 3))),
        translation=random.normal(size=(frames, 3)),
        gaze=random.normal(size=(frames, 2, 2)),
        lost=np.arange(frames) == 2,
        residual=random.uniform(size=frames),
    )


def test_in_and_out_again_is_the_same_to_nine_digits(tmp_path: Path) -> None:
    curves = make()
    write_table(tmp_path / "man.csv", curves)
    found = read_table(tmp_path / "man.csv")
    assert (found.character, found.names) == (curves.character, curves.names)
    for name in ("time", "weights", "rotation", "translation", "gaze", "lost", "residual"):
        np.testing.assert_allclose(
            getattr(found, name), getattr(curves, name), rtol=1e-9, atol=1e-9
        )


def test_a_row_a_frame_a_column_a_morph_target(tmp_path: Path) -> None:
    write_table(tmp_path / "man.csv", make(6))
    lines = (tmp_path / "man.csv").read_text().splitlines()
    assert len(lines) == 7
    assert lines[0].split(",")[len(FIXED)] == "jaw_open"


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("time_s", "time", "not a table"),
        ("jaw_open", "smile", "line 2"),
        ("\n0.", "\nx.", "line 2"),
        ("head_qw", "head_qq", "not a table"),
    ],
)
def test_damage_is_named(tmp_path: Path, old: str, new: str, said: str) -> None:
    path = tmp_path / "man.csv"
    write_table(path, make())
    text = path.read_text()
    if old == "jaw_open":
        text = text.replace("jaw_open,", "")
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(FormatError, match=said):
        read_table(path)


def test_what_is_no_rotation_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "man.csv"
    write_table(path, make())
    header, *rows = path.read_text().splitlines()
    cells = [row.split(",") for row in rows]
    cells[0][3:7] = ["0"] * 4
    path.write_text("\n".join([header, *map(",".join, cells)]))
    with pytest.raises(FormatError, match="rotation"):
        read_table(path)
