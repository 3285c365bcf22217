"""Folders of pictures: natural order, upright, one size."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from clips import corners, quarters
from mien.errors import FormatError, InputError
from mien.formats.pictures.images import open_images
from mien.formats.pictures.sources import open_source


def test_names_are_ordered_as_people_count(tmp_path: Path) -> None:
    for i in (10, 9, 100, 1):
        Image.fromarray(np.full((8, 8, 3), i, np.uint8)).save(tmp_path / f"frame{i}.png")
    (tmp_path / "notes.txt").write_text("not a picture")
    frames = list(open_source(tmp_path, rate=10.0))
    assert [int(frame.image[0, 0, 0]) for frame in frames] == [1, 9, 10, 100]
    assert [frame.time for frame in frames] == pytest.approx([0.0, 0.1, 0.2, 0.3])


def test_exif_orientation_is_honoured_and_then_mirrored(tmp_path: Path) -> None:
    exif = Image.Exif()
    exif[0x0112] = 6  # turn clockwise to see it upright
    for i in range(2):
        Image.fromarray(quarters()).save(tmp_path / f"{i}.png", exif=exif)
    source = open_images(tmp_path)
    assert source.size == (48, 64)
    assert corners(next(iter(source)).image) == ["blue", "red", "white", "green"]
    mirrored = open_images(tmp_path, mirror=True)
    assert corners(next(iter(mirrored)).image) == ["red", "blue", "green", "white"]


def test_grey_and_transparent_pictures_become_rgb(tmp_path: Path) -> None:
    Image.new("L", (8, 8), 77).save(tmp_path / "0.png")
    Image.new("RGBA", (8, 8), (77, 77, 77, 10)).save(tmp_path / "1.png")
    for frame in open_images(tmp_path):
        np.testing.assert_array_equal(frame.image, np.full((8, 8, 3), 77, np.uint8))


def test_start_and_end_choose_by_time(tmp_path: Path) -> None:
    for i in range(10):
        Image.new("RGB", (8, 8), (i, 0, 0)).save(tmp_path / f"{i}.png")
    frames = list(open_images(tmp_path, start=0.2, end=0.5, rate=10.0))
    assert [int(frame.image[0, 0, 0]) for frame in frames] == [2, 3, 4]
    assert frames[0].time == 0.0
    with pytest.raises(InputError, match="between --start and --end"):
        open_images(tmp_path, start=0.9, rate=10.0)


def test_what_cannot_be_read_is_named(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="no pictures"):
        open_images(tmp_path)
    Image.new("RGB", (8, 8)).save(tmp_path / "0.png")
    (tmp_path / "1.png").write_bytes(b"not a picture")
    with pytest.raises(FormatError, match=r"1\.png"):
        list(open_images(tmp_path))
    Image.new("RGB", (9, 8)).save(tmp_path / "1.png")
    with pytest.raises(FormatError, match="one size"):
        list(open_images(tmp_path))
    whole = (tmp_path / "0.png").read_bytes()
    (tmp_path / "0.png").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(FormatError, match=r"0\.png"):
        open_images(tmp_path)
