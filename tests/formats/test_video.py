"""Video files: upright, square, at the file's own times, and honest about damage."""

from __future__ import annotations

import threading
from collections.abc import Generator
from contextlib import suppress
from fractions import Fraction
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clips import corners, noise, quarters, write_video
from mien.errors import FormatError, InputError, MienError
from mien.formats.pictures.ahead import read_ahead
from mien.formats.pictures.sources import open_source
from mien.formats.pictures.video import open_video


@pytest.fixture(scope="module")
def cut_able(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A video whose index stands in front, so that FFmpeg opens it whatever follows."""
    path = tmp_path_factory.mktemp("video") / "noise.mp4"
    return write_video(path, noise(30), options={"movflags": "faststart"})


@pytest.mark.parametrize(
    ("rotation", "expected"),
    [
        (0, ["red", "green", "blue", "white"]),
        (90, ["green", "white", "red", "blue"]),
        (180, ["white", "blue", "green", "red"]),
        (-90, ["blue", "red", "white", "green"]),
    ],
)
def test_a_phones_rotation_is_honoured(tmp_path: Path, rotation: int, expected: list[str]) -> None:
    path = write_video(tmp_path / "phone.mp4", [quarters()] * 3, rotation=rotation)
    frame = next(iter(open_video(path)))
    assert corners(frame.image) == expected
    assert frame.image.shape[:2] == ((64, 48) if rotation % 180 else (48, 64))


def test_mirror_undoes_a_selfie_take_also_when_turned(tmp_path: Path) -> None:
    path = write_video(tmp_path / "selfie.mp4", [quarters()] * 3, rotation=90)
    assert corners(next(iter(open_video(path, mirror=True))).image) == [
        "white",
        "green",
        "blue",
        "red",
    ]


def test_pixels_are_made_square(tmp_path: Path) -> None:
    path = write_video(tmp_path / "d.mp4", [quarters(128, 120)] * 2, aspect=Fraction(15, 16))
    video = open_video(path)
    assert video.size == (120, 120)
    assert next(iter(video)).image.shape == (120, 120, 3)


def test_ten_bit_hevc_is_read(tmp_path: Path) -> None:
    pictures = [quarters(128, 96)] * 3
    path = write_video(tmp_path / "hdr.mp4", pictures, codec="libx265", pixels="yuv420p10le")
    assert corners(next(iter(open_video(path))).image) == ["red", "green", "blue", "white"]


@pytest.mark.parametrize("first", [0.0, 1.5])
def test_times_are_the_files_own_and_count_from_its_first_picture(
    tmp_path: Path, first: float
) -> None:
    times = [0.0, 1 / 30, 2 / 30, 0.0667 + 1 / 24, 0.0667 + 2 / 24, 0.4]
    path = write_video(tmp_path / "vfr.mkv", noise(6), times, first=first)
    frames = list(open_video(path))
    # Matroska counts in milliseconds.
    np.testing.assert_allclose([frame.time for frame in frames], times, atol=1.1e-3)


def test_start_and_end_choose_by_time_and_time_begins_anew(tmp_path: Path) -> None:
    path = write_video(tmp_path / "take.mp4", noise(60))
    video = open_video(path, start=0.5, end=1.5)
    times = [frame.time for frame in video]
    assert len(times) == video.count == 30
    assert times[0] == 0.0
    assert times[-1] == pytest.approx(29 / 30)


def test_a_late_start_is_sought_and_shows_the_same_pictures(tmp_path: Path) -> None:
    pictures = [np.full((48, 64, 3), i % 250, np.uint8) for i in range(450)]
    path = write_video(tmp_path / "long.mp4", pictures, options={"g": "60"})
    whole = [frame.image for frame in open_video(path)]
    late = [frame.image for frame in open_video(path, start=12.0)]
    assert len(late) == 450 - 360
    for a, b in zip(whole[360:], late, strict=True):
        np.testing.assert_array_equal(a, b)


def test_a_source_can_be_read_twice_and_left_early(tmp_path: Path) -> None:
    source = open_source(write_video(tmp_path / "take.mp4", noise(40)))
    before = threading.active_count()
    reading = iter(source)
    next(reading)
    assert threading.active_count() == before + 1
    reading.close()  # type: ignore[attr-defined]
    assert threading.active_count() == before
    assert len(list(source)) == len(list(source)) == 40


def test_reading_ahead_hands_on_errors_after_the_items_before_them() -> None:
    def three() -> Generator[int, None, None]:
        yield from (1, 2, 3)
        raise FormatError("broken here")

    items = read_ahead(three(), depth=2)
    assert [next(items), next(items), next(items)] == [1, 2, 3]
    with pytest.raises(FormatError, match="broken here"):
        next(items)


@pytest.mark.parametrize("share", [0.02, 0.3, 0.7, 0.95])
@pytest.mark.parametrize("ending", [".mp4", ".mkv"])
def test_a_video_that_was_cut_off_is_refused(
    tmp_path: Path, cut_able: Path, share: float, ending: str
) -> None:
    if ending == ".mkv":
        whole = write_video(tmp_path / "noise.mkv", noise(120)).read_bytes()
        share = min(share, 0.7)
    else:
        whole = cut_able.read_bytes()
    path = tmp_path / f"cut{ending}"
    path.write_bytes(whole[: int(len(whole) * share)])
    with pytest.raises(FormatError, match="cut"):
        list(open_video(path))


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"this is a letter, not a video\n" * 200,
        b"#EXTM3U\n#EXT-X-TARGETDURATION:9\n#EXTINF:9,\nother.mp4\n",
        b"ffconcat version 1.0\nfile other.mp4\n",
        b"RIFF\x00\x00\x00\x00WAVEfmt ",
    ],
    ids=["empty", "text", "playlist", "concat script", "sound"],
)
def test_what_is_no_video_is_refused_in_one_line(tmp_path: Path, content: bytes) -> None:
    write_video(tmp_path / "other.mp4", noise(3))
    path = tmp_path / "take.mp4"
    path.write_bytes(content)
    with pytest.raises(FormatError) as caught:
        open_video(path)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


def test_one_picture_is_no_performance(tmp_path: Path) -> None:
    path = write_video(tmp_path / "still.mp4", noise(1))
    with pytest.raises(FormatError, match="at least two"):
        list(open_video(path))
    path = write_video(tmp_path / "take.mp4", noise(10))
    with pytest.raises(InputError, match="between --start and --end"):
        list(open_video(path, start=5.0))


def test_a_name_with_a_colon_is_a_file(tmp_path: Path) -> None:
    path = write_video(tmp_path / "take 10:15.mp4", noise(3))
    assert len(list(open_video(path))) == 3


@pytest.mark.parametrize(("start", "end"), [(-1.0, None), (2.0, 1.0), (float("nan"), None)])
def test_senseless_cuts_are_refused(tmp_path: Path, start: float, end: float | None) -> None:
    path = write_video(tmp_path / "take.mp4", noise(3))
    with pytest.raises(InputError, match="--start"):
        open_source(path, start, end)


def test_what_is_not_there_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        open_source(tmp_path / "absent.mp4")
    with pytest.raises(InputError, match="camera:0"):
        open_source("camera:front", end=1.0)


def test_a_code_nobody_knows_is_told(tmp_path: Path, cut_able: Path) -> None:
    content = cut_able.read_bytes()
    path = tmp_path / "odd.mp4"
    path.write_bytes(content.replace(b"avc1\0\0\0", b"xyzw\0\0\0"))
    assert path.read_bytes() != content
    with pytest.raises(FormatError):
        list(open_video(path))


@settings(
    max_examples=40, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_damage_never_ends_in_anything_but_a_plain_error(
    tmp_path: Path, cut_able: Path, data: st.DataObject
) -> None:
    broken = bytearray(cut_able.read_bytes())
    for _ in range(data.draw(st.integers(1, 8))):
        broken[data.draw(st.integers(0, len(broken) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / "broken.mp4"
    path.write_bytes(broken)
    with suppress(MienError):
        times = [frame.time for frame in open_video(path)]
        assert all(b > a for a, b in pairwise(times))
