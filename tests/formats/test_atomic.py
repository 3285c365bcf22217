"""Output is whole or absent, and its errors are one line."""

from __future__ import annotations

import errno
from pathlib import Path

import pytest

from mien.errors import OutputError
from mien.formats.atomic import whole_file, whole_folder


def fail_half_way(path: Path, error: BaseException) -> None:
    with whole_file(path) as temporary:
        temporary.write_bytes(b"half")
        raise error


def test_a_file_appears_only_when_whole(tmp_path: Path) -> None:
    path = tmp_path / "a.glb"
    with whole_file(path) as temporary:
        temporary.write_bytes(b"new")
        assert temporary.suffix == ".glb"
        assert not path.exists()
    assert path.read_bytes() == b"new"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("interruption", [KeyboardInterrupt, ValueError])
def test_an_interruption_leaves_what_was_there(
    tmp_path: Path, interruption: type[BaseException]
) -> None:
    path = tmp_path / "a.glb"
    path.write_bytes(b"old")
    with pytest.raises(interruption):
        fail_half_way(path, interruption())
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_a_full_disk_is_one_line_and_leaves_nothing(tmp_path: Path) -> None:
    path = tmp_path / "a.mp4"
    with pytest.raises(OutputError, match=r"a\.mp4: the disk is full"):
        fail_half_way(path, OSError(errno.ENOSPC, "No space left on device"))
    assert not list(tmp_path.iterdir())


def test_a_missing_folder_and_a_folder_in_the_way_are_named(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="folder does not exist"), whole_file(tmp_path / "no/a"):
        pass
    (tmp_path / "taken").mkdir()
    with (
        pytest.raises(OutputError, match="a folder of that name"),
        whole_file(tmp_path / "taken") as temporary,
    ):
        temporary.write_text("x")


def test_a_folder_replaces_an_earlier_result(tmp_path: Path) -> None:
    path = tmp_path / "frames"
    for name in ("1.obj", "2.obj"):
        with whole_folder(path) as temporary:
            (temporary / name).write_text(name)
    assert [entry.name for entry in path.iterdir()] == ["2.obj"]
    assert list(tmp_path.iterdir()) == [path]


def test_a_folder_with_somebody_elses_files_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "frames"
    path.mkdir()
    (path / "thesis.tex").write_text("precious")
    with (
        pytest.raises(OutputError, match="other content"),
        whole_folder(path) as temporary,
    ):
        (temporary / "1.obj").write_text("x")
    assert (path / "thesis.tex").read_text() == "precious"
    assert list(tmp_path.iterdir()) == [path]
