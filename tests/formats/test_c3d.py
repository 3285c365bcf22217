"""C3D: every flavour reads alike, a foreign writer's file too, and nothing in one is believed."""

from __future__ import annotations

import struct
from pathlib import Path

import ezc3d
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mien.errors import FormatError, InputError
from mien.formats.markers.c3d import read_c3d
from mien.performance.marker_take import MarkerTake
from takes import c3d


def small(frames: int = 7) -> MarkerTake:
    places = np.random.default_rng(1).uniform(-300.0, 300.0, (frames, 4, 3))
    places[2, 1] = np.nan
    return MarkerTake(("LBrowIn", "RBrowIn", "NoseTip", "JigTop"), np.arange(frames) / 60, places)


@pytest.mark.parametrize("processor", [84, 85, 86])
@pytest.mark.parametrize("integer", [False, True])
def test_every_flavour_reads_alike(tmp_path: Path, processor: int, integer: bool) -> None:
    take = small()
    path = c3d(take, tmp_path / "a.c3d", processor=processor, integer=integer)
    again = read_c3d(path)
    assert again.labels == take.labels
    assert again.rate == pytest.approx(60.0)
    assert (np.isnan(again.places) == np.isnan(take.places)).all()
    assert np.nanmax(np.abs(again.places - take.places)) < (0.03 if integer else 1e-4)


def test_a_foreign_writers_file_reads(tmp_path: Path) -> None:
    take, foreign = small(), ezc3d.c3d()
    foreign["parameters"]["POINT"]["UNITS"]["value"] = ["m"]
    foreign["parameters"]["POINT"]["RATE"]["value"] = [60.0]
    foreign["parameters"]["POINT"]["LABELS"]["value"] = [f"Vera:{name}" for name in take.labels]
    points = np.ones((4, 4, len(take)))
    points[:3] = np.moveaxis(take.places, -1, 0).swapaxes(1, 2) / 1000.0
    foreign["data"]["points"] = points
    foreign.write(str(tmp_path / "foreign.c3d"))
    again = read_c3d(tmp_path / "foreign.c3d")
    assert again.labels == take.labels
    assert again.unit == 1000.0
    assert np.nanmax(np.abs(again.places - take.places)) < 1e-3
    assert np.isnan(again.places[2, 1]).all()


def test_more_frames_than_sixteen_bits_hold(tmp_path: Path) -> None:
    places = np.ones((70_000, 1, 3))
    path = c3d(MarkerTake(("A",), np.arange(70_000) / 100, places), tmp_path / "long.c3d")
    data = bytearray(path.read_bytes())
    # TRIAL:ACTUAL_END_FIELD as two words, in a group of its own behind the others.
    end = data.rindex(b"mm") + 3
    group = struct.pack("bb", 5, -2) + b"TRIAL" + struct.pack("<h", 3) + b"\0"
    for name, frame in ((b"ACTUAL_START_FIELD", 1), (b"ACTUAL_END_FIELD", 70_000)):
        body = struct.pack("<bBB2H", 2, 1, 2, frame % 65536, frame // 65536) + b"\0"
        group += struct.pack("bb", len(name), 2) + name + struct.pack("<h", len(body) + 2) + body
    data[end : end + len(group)] = group
    path.write_bytes(data)
    assert len(read_c3d(path)) == 70_000


@pytest.mark.parametrize(("said", "likely"), [(None, "mm"), ("parsec", "mm")])
def test_an_unknown_unit_is_asked_for(tmp_path: Path, said: str | None, likely: str) -> None:
    path = c3d(small(), tmp_path / "a.c3d", units=said)
    with pytest.raises(FormatError, match=f"likely --units {likely}"):
        read_c3d(path)
    assert read_c3d(path, "m").unit == 1000.0


def test_the_likely_unit_is_that_of_a_face(tmp_path: Path) -> None:
    take = small()
    metres = MarkerTake(take.labels, take.time, take.places / 3000.0)
    with pytest.raises(FormatError, match="likely --units m"):
        read_c3d(c3d(metres, tmp_path / "a.c3d", units=None))


@pytest.mark.parametrize(
    ("take", "what"),
    [
        (MarkerTake((), np.zeros(3), np.zeros((3, 0, 3))), "no markers"),
        (MarkerTake(("A",), np.zeros(0), np.zeros((0, 1, 3))), "no markers"),
        (MarkerTake(("A",), np.arange(3) / 60, np.full((3, 1, 3), np.nan)), "no marker was seen"),
    ],
)
def test_an_empty_take_is_told(tmp_path: Path, take: MarkerTake, what: str) -> None:
    labelled = MarkerTake(take.labels, np.arange(max(len(take), 2)) / 60, take.places)
    with pytest.raises(FormatError, match=what):
        read_c3d(c3d(labelled, tmp_path / "a.c3d", labels=("A",)))


def test_a_promise_is_not_believed(tmp_path: Path) -> None:
    data = c3d(small(), tmp_path / "a.c3d").read_bytes()
    (tmp_path / "cut.c3d").write_bytes(data[:-40])
    with pytest.raises(FormatError, match="promises 7 frames and holds 6"):
        read_c3d(tmp_path / "cut.c3d")
    with pytest.raises(InputError):
        read_c3d(tmp_path / "none.c3d")
    (tmp_path / "text.c3d").write_text("not a capture" * 200)
    with pytest.raises(FormatError, match="not a C3D"):
        read_c3d(tmp_path / "text.c3d")


@settings(
    max_examples=300, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    cut=st.integers(1, 4000),
    hits=st.lists(st.tuples(st.integers(0, 1600), st.integers(0, 255)), max_size=6),
)
def test_damage_is_told_and_does_no_harm(
    tmp_path: Path, cut: int, hits: list[tuple[int, int]]
) -> None:
    data = bytearray(c3d(small(), tmp_path / "a.c3d").read_bytes())
    for place, value in hits:
        data[place % len(data)] = value
    (tmp_path / "b.c3d").write_bytes(data[:cut])
    said = None
    try:
        take = read_c3d(tmp_path / "b.c3d", "mm")
        assert take.places.shape == (len(take.time), len(take.labels), 3)
    except InputError as error:
        said = str(error)
    assert said is None or (said.startswith(str(tmp_path)) and "\n" not in said)
