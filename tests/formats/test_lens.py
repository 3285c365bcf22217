"""Camera files: what is read, and what is refused in one line."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mien.errors import FormatError, InputError, MienError
from mien.formats.pictures.lens import read_focal


@pytest.mark.parametrize(
    ("name", "text", "found"),
    [
        ("a.toml", "focal = 700.5\nwidth = 640", (700.5, 640.0)),
        ("a.toml", "focal = 700", (700.0, None)),
        ("a.json", '{"camera_matrix": [[812, 0, 320], [0, 812, 240], [0, 0, 1]]}', (812.0, None)),
    ],
)
def test_focal_lengths_are_read(tmp_path: Path, name: str, text: str, found: object) -> None:
    (tmp_path / name).write_text(text)
    assert read_focal(tmp_path / name) == found


@pytest.mark.parametrize("text", ["", "focal = 'long'", "focal = nan", "focal = -3", "width = 3"])
def test_what_is_no_camera_is_refused(tmp_path: Path, text: str) -> None:
    (tmp_path / "a.toml").write_text(text)
    with pytest.raises(FormatError, match=r"a\.toml"):
        read_focal(tmp_path / "a.toml")


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="--focal"):
        read_focal(tmp_path / "none.toml")


@given(st.binary(max_size=200), st.sampled_from([".toml", ".json"]))
def test_any_bytes_are_read_or_refused(tmp_path_factory, content: bytes, ending: str) -> None:
    path = tmp_path_factory.mktemp("lens") / f"a{ending}"
    path.write_bytes(content)
    with suppress(MienError):
        assert read_focal(path)[0] > 1
