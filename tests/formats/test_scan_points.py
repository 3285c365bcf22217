"""Points of a scan: what is written is read, and what people write is checked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from mien.errors import FormatError, InputError
from mien.formats.notes.scan_points import PointsFile, read_points, write_points


def test_what_is_written_is_read(tmp_path: Path) -> None:
    places = np.array([[25.91, -43.02, 92.4], [1e-3, 0.0, -1e3]])
    path = tmp_path / "head.points.toml"
    write_points(path, PointsFile('my "best"\\ head.ply', True, ("8.3", "2.1"), places))
    points = read_points(path)
    assert points.scan == 'my "best"\\ head.ply'
    assert points.found
    assert points.ids == ("8.3", "2.1")
    assert points.places == pytest.approx(places)
    assert "left corner" in path.read_text().lower(), "people are told what a point is"


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "no \\[points\\]"),
        ("found = 3\n[points]", "true or false"),
        ("[points]\n'99.9' = [1, 2, 3]", "99.9"),
        ("[points]\n'8.3' = [1, 2]", "8.3"),
        ("[points]\n'8.3' = [1, 2, nan]", "8.3"),
        ("[points]\n'8.3' = [1, 2, true]", "8.3"),
        ("points = 3 4", "not a table"),
        ("[" * 5000, "not a table"),
        ("#" * (1 << 21), "too large"),
    ],
)
def test_a_broken_list_is_told(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "head.points.toml"
    path.write_text(text)
    with pytest.raises(FormatError, match=told) as raised:
        read_points(path)
    assert "head.points.toml" in str(raised.value)
    assert "\n" not in str(raised.value)


def test_a_list_that_is_not_there_is_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_points(tmp_path / "absent.toml")
