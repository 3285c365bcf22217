"""Archives that somebody sends: inside their folder, within bounds, or refused in a line."""

from __future__ import annotations

import zipfile
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mien.errors import FormatError
from mien.formats.unpack import unpack


def packed(path: Path, files: dict[str, bytes]) -> Path:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, body in files.items():
            archive.writestr(name, body)
    return path


def test_files_come_out_as_they_went_in(tmp_path: Path) -> None:
    files = {"head/neutral.obj": b"v 0 0 0\n", "readme.txt": b"a head"}
    unpack(packed(tmp_path / "a.zip", files), tmp_path / "out")
    found = {
        str(path.relative_to(tmp_path / "out")): path.read_bytes()
        for path in (tmp_path / "out").rglob("*")
        if path.is_file()
    }
    assert found == files


@pytest.mark.parametrize("name", ["../a.obj", "/a.obj", "a/../../b.obj", "..\\a.obj", "C:a.obj"])
def test_nothing_lies_outside(tmp_path: Path, name: str) -> None:
    with pytest.raises(FormatError, match="elsewhere"):
        unpack(packed(tmp_path / "a.zip", {name: b"x"}), tmp_path / "in" / "out")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.zip"]


def test_bombs_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mien.formats.unpack.MAX_BYTES", 1 << 20)
    with pytest.raises(FormatError, match="unpacked"):
        unpack(packed(tmp_path / "a.zip", {"a": bytes(3 << 20)}), tmp_path / "out")
    monkeypatch.setattr("mien.formats.unpack.MAX_FILES", 3)
    with pytest.raises(FormatError, match="files"):
        unpack(packed(tmp_path / "b.zip", {str(i): b"" for i in range(5)}), tmp_path / "out")


@settings(max_examples=80, deadline=None)
@given(cut=st.integers(0, 300), at=st.integers(0, 300), bit=st.integers(0, 7))
def test_damage_is_refused_and_never_a_traceback(
    tmp_path_factory: pytest.TempPathFactory, cut: int, at: int, bit: int
) -> None:
    folder = tmp_path_factory.mktemp("damaged")
    path = packed(folder / "a.zip", {"a.obj": b"v 0 0 0\n" * 40, "b.obj": b"f 1 2 3\n"})
    body = bytearray(path.read_bytes())
    body[at % len(body)] ^= 1 << bit
    path.write_bytes(bytes(body[: len(body) - cut % 3 * cut]))
    with suppress(FormatError):
        unpack(path, folder / "out")
