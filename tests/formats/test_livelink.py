"""Live Link Face takes: bound by name, out and in again the same, damage told in one line."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mien.errors import FormatError
from mien.formats.takes.livelink import TICKS, read_livelink, write_livelink
from mien.numeric.euler import from_euler
from mien.vocabulary.arkit import face_shapes, names
from mien.vocabulary.livelink import csv_columns, stream_columns


def take(frames: int = 5, seed: int = 0) -> dict[str, np.ndarray]:
    """What ten decimals and a time code hold exactly."""
    random = np.random.default_rng(seed)
    return {
        "time": np.cumsum(np.r_[0, random.integers(1, 9000, frames - 1)]) / TICKS,
        "shapes": np.round(random.uniform(0, 1.05, (frames, 52)), 10),
        "rotation": from_euler(np.round(random.uniform(-1.2, 1.2, (frames, 3)), 10)),
        "gaze": np.round(random.uniform(-0.8, 0.8, (frames, 2, 2)), 10),
    }


@settings(
    deadline=None, max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(frames=st.integers(2, 9), seed=st.integers(0, 999))
def test_out_and_in_again_gives_the_same_values(tmp_path: Path, frames: int, seed: int) -> None:
    given_take = take(frames, seed)
    write_livelink(tmp_path / "take.csv", **given_take)
    found = read_livelink(tmp_path / "take.csv")
    for name, value in given_take.items():
        np.testing.assert_allclose(getattr(found, name), value, rtol=0, atol=2e-12)
    assert found.vocabulary == "arkit"
    again = tmp_path / "again.csv"
    write_livelink(again, found.time, found.shapes, found.rotation, found.gaze)
    assert again.read_bytes() == (tmp_path / "take.csv").read_bytes()


def test_columns_are_bound_by_name_and_sides_stay(tmp_path: Path) -> None:
    order = names()
    values = take(2)
    values["shapes"][:] = 0.0
    values["shapes"][:, order.index("jawLeft")] = 0.25
    values["shapes"][:, order.index("mouthRight")] = 0.75
    write_livelink(tmp_path / "take.csv", **values)
    header, row = (line.split(",") for line in (tmp_path / "take.csv").read_text().split("\n")[:2])
    assert float(row[header.index("JawLeft")]) == 0.25
    assert header.index("JawRight") < header.index("JawLeft")
    plain = read_livelink(tmp_path / "take.csv").shapes[0]
    swapped = read_livelink(tmp_path / "take.csv", swap_sideways=True).shapes[0]
    assert plain[order.index("jawLeft")] == swapped[order.index("jawRight")] == 0.25
    assert plain[order.index("mouthRight")] == swapped[order.index("mouthLeft")] == 0.75


def test_angles_mean_what_the_phone_means(tmp_path: Path) -> None:
    values = take(2)
    values["rotation"] = from_euler(np.array([[0.1, 0.2, 0.3]] * 2))  # left, up, leaning left
    values["gaze"][:] = [0.4, 0.5]  # left, up
    write_livelink(tmp_path / "take.csv", **values)
    header, row = (line.split(",") for line in (tmp_path / "take.csv").read_text().split("\n")[:2])
    found = {name: float(row[header.index(name)]) for name in header[2:]}
    assert (found["HeadYaw"], found["HeadPitch"], found["HeadRoll"]) == (-0.1, -0.2, 0.3)
    assert found["LeftEyeYaw"] == found["RightEyeYaw"] == -0.4
    assert found["LeftEyePitch"] == found["RightEyePitch"] == -0.5


def write(path: Path, rows: list[str], columns: tuple[str, ...] = csv_columns()) -> Path:
    header = ",".join(("Timecode", "BlendShapeCount", *columns))
    path.write_text("\n".join([header, *rows]) + "\n")
    return path


def row(timecode: str, value: float = 0.5, count: int = 61) -> str:
    return ",".join([timecode, str(count), *[str(value)] * count])


def test_time_comes_from_the_time_code(tmp_path: Path) -> None:
    codes = ["23:59:59:58.500", "23:59:59:59.500", "00:00:00:02.000", "00:00:01:00.000"]
    path = write(tmp_path / "take.csv", [row(code) for code in codes])
    np.testing.assert_allclose(
        read_livelink(path).time, np.array([0.0, 1.0, 3.5, 61.5]) / 60.0, atol=1e-12
    )


def test_a_take_without_angles_looks_where_its_weights_look(tmp_path: Path) -> None:
    columns = csv_columns()[:52]
    look = ["0"] * 52
    for name in ("EyeLookOutLeft", "EyeLookInRight"):  # both eyes to the subject's left
        look[columns.index(name)] = "0.5"
    rows = [",".join([code, "52", *look]) for code in ("00:00:00:00.000", "00:00:00:01.000")]
    found = read_livelink(write(tmp_path / "take.csv", rows, columns))
    np.testing.assert_allclose(found.gaze, np.full((2, 2, 1), [[[0.3]]]) * [1.0, 0.0])
    np.testing.assert_array_equal(found.rotation, np.broadcast_to(np.eye(3), (2, 3, 3)))


def test_a_row_without_values_is_a_lost_frame_that_repeats_the_last(tmp_path: Path) -> None:
    rows = [row("00:00:00:00.000", 0.25), "00:00:00:01.000,0", row("00:00:00:02.000", 0.75)]
    found = read_livelink(write(tmp_path / "take.csv", rows))
    assert found.lost.tolist() == [False, True, False]
    assert found.shapes[:, 0].tolist() == [0.25, 0.25, 0.75]


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ([], "at least two"),
        ([row("00:00:00:00"), row("00:00:00:00")], "goes back"),
        ([row("00:00:00:60.000")] * 2, "time code"),
        ([row("nonsense")] * 2, "time code"),
        ([row("00:00:00:00"), row("00:00:00:01", float("nan"))], "beyond"),
        ([row("00:00:00:00"), row("00:00:00:01", 1e300)], "beyond"),
        ([row("00:00:00:00"), row("00:00:00:01", count=60)], "expected 61"),
        ([row("00:00:00:00"), "00:00:00:01,61," + "x," * 60 + "x"], "line 3"),
    ],
)
def test_damaged_rows_are_named(tmp_path: Path, rows: list[str], said: str) -> None:
    with pytest.raises(FormatError, match=said):
        read_livelink(write(tmp_path / "take.csv", rows))


def test_headers_that_lack_or_repeat_a_shape_are_refused(tmp_path: Path) -> None:
    with pytest.raises(FormatError, match="no column TongueOut"):
        read_livelink(
            write(tmp_path / "a.csv", [], tuple(c for c in csv_columns() if c != "TongueOut"))
        )
    with pytest.raises(FormatError, match="same name"):
        read_livelink(write(tmp_path / "b.csv", [], (*csv_columns(), "JawOpen")))
    (tmp_path / "c.csv").write_bytes(b"\xff\xfe\x00binary")
    with pytest.raises(FormatError, match="not a Live Link"):
        read_livelink(tmp_path / "c.csv")


@settings(
    deadline=None, max_examples=100, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_damage_never_ends_in_anything_but_a_plain_error(
    tmp_path: Path, data: st.DataObject
) -> None:
    path = tmp_path / "take.csv"
    write_livelink(path, **take(3))
    broken = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 6))):
        broken[data.draw(st.integers(0, len(broken) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(broken)
    with suppress(FormatError):
        assert np.isfinite(read_livelink(path).shapes).all()


@pytest.mark.skipif("MIEN_TEST_DATA" not in os.environ, reason="MIEN_TEST_DATA names no takes")
@pytest.mark.parametrize(
    ("name", "frames", "seconds"),
    [("sentien_recording", 1628, 27.15997), ("alexdjulin_rom_4_first1000", 1000, 33.32877)],
)
def test_takes_of_real_phones_are_read(
    tmp_path: Path, name: str, frames: int, seconds: float
) -> None:
    found = read_livelink(Path(os.environ["MIEN_TEST_DATA"], "livelink", f"{name}.csv"))
    assert len(found) == frames
    assert found.time[-1] == pytest.approx(seconds, abs=1e-4)
    write_livelink(tmp_path / "a.csv", found.time, found.shapes, found.rotation, found.gaze)
    again = read_livelink(tmp_path / "a.csv")
    np.testing.assert_allclose(again.shapes, found.shapes, atol=1e-10)
    np.testing.assert_allclose(again.rotation, found.rotation, atol=1e-9)


def test_the_vocabulary_is_whole() -> None:
    shapes = face_shapes()
    assert len(shapes) == 52
    assert all(shapes[shape.mirror].mirror == name for name, shape in shapes.items())
    assert sorted(shape.csv for shape in shapes.values()) == list(range(52))
    assert sorted(shape.mediapipe or 0 for shape in shapes.values()) == list(range(52))
    stream, table = stream_columns(), csv_columns()
    assert {a for a, b in zip(stream, table, strict=True) if a != b} == {
        "JawLeft",
        "JawRight",
        "MouthLeft",
        "MouthRight",
    }
