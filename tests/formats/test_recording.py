"""A take that is appended while it happens survives what interrupts it."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mien.errors import FormatError, InputError, OutputError
from mien.formats.takes.recording import Recorder, read_recording
from mien.performance.acted import acted
from mien.performance.arkit_frame import ArkitFrame, performance_of
from mien.performance.performance import Performance, Span

FRAMES = 9


def seen() -> Performance:
    random = np.random.default_rng(5)
    performance = acted(
        ("2.1", "8.3", "8.4"),
        random.normal(size=(3, 3)),
        random.normal(size=(FRAMES, 3, 3)),
        sigma=np.ones(3),
        spans=(Span("8.3", "8.4", 0, 0.7),),
        scalars={"lid_left": random.uniform(size=FRAMES)},
    )
    return replace(performance, lost=np.arange(FRAMES) == 4, source="a test")


def heard() -> Performance:
    shapes = np.random.default_rng(6).uniform(size=(FRAMES, 52))
    return performance_of([ArkitFrame(i / 30, row) for i, row in enumerate(shapes)], "a stream")


def recorded(path: Path, performance: Performance) -> Path:
    recorder = Recorder(path, performance)
    for frame in range(FRAMES):
        recorder.write(performance[frame : frame + 1])
    recorder.close()
    return path


@pytest.mark.parametrize("make", [seen, heard])
def test_what_is_recorded_is_read(make, tmp_path: Path) -> None:
    performance = make()
    found = read_recording(recorded(tmp_path / "a.take", performance))
    for field in fields(Performance):
        expected, got = getattr(performance, field.name), getattr(found, field.name)
        if isinstance(expected, np.ndarray):
            np.testing.assert_array_equal(got, expected, err_msg=field.name)
        elif field.name == "scalars":
            np.testing.assert_array_equal(got.get("lid_left", []), expected.get("lid_left", []))
        else:
            assert got == expected


def test_every_frame_is_in_the_file_before_the_next_comes(tmp_path: Path) -> None:
    performance, path = seen(), tmp_path / "a.take"
    recorder = Recorder(path, performance)
    for frame in range(3):
        recorder.write(performance[frame : frame + 1])
        assert len(read_recording(path)) == frame + 1
    # Nobody closed it: so it is when a program is killed.


def test_frames_that_go_back_in_time_are_passed_over(tmp_path: Path) -> None:
    performance, path = seen(), tmp_path / "a.take"
    recorder = Recorder(path, performance)
    for frame in (0, 1, 3, 2, 3, 4):
        recorder.write(performance[frame : frame + 1])
    recorder.close()
    found = read_recording(path)
    np.testing.assert_array_equal(found.motion, performance.motion[[0, 1, 3, 4]])


def test_a_cut_take_ends_with_its_last_whole_frame(tmp_path: Path) -> None:
    path = recorded(tmp_path / "a.take", seen())
    whole = path.read_bytes()
    path.write_bytes(whole[:-5])
    assert len(read_recording(path)) == FRAMES - 1
    path.write_bytes(whole[:60])
    with pytest.raises(FormatError, match=r"a\.take: not a recorded take"):
        read_recording(path)


@given(data=st.data())
@settings(
    suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60, deadline=None
)
def test_damage_is_refused_or_cut_off(data: st.DataObject, tmp_path: Path) -> None:
    path = recorded(tmp_path / "a.take", seen())
    bytes_ = bytearray(path.read_bytes())
    for place in data.draw(st.lists(st.integers(0, len(bytes_) - 1), min_size=1, max_size=4)):
        bytes_[place] ^= 1 << data.draw(st.integers(0, 7))
    path.write_bytes(bytes_)
    with suppress(FormatError):
        assert 1 <= len(read_recording(path)) <= FRAMES


def test_a_missing_take_and_a_folder_that_is_none(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_recording(tmp_path / "none.take")
    with pytest.raises(OutputError, match="cannot be written"):
        Recorder(tmp_path / "nowhere" / "a.take", seen())
