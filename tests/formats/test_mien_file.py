"""The performance file: exact round trip, and nothing but a plain error from damage."""

from __future__ import annotations

import json
import zipfile
from contextlib import suppress
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mien.errors import FormatError, OutputError
from mien.formats.archive import HEADER
from mien.formats.takes.mien_file import read_performance, write_performance
from mien.numeric.rotation import from_vector
from mien.performance.performance import Performance, Span


def make(frames: int = 7, points: int = 4, weights: int = 3, seed: int = 0) -> Performance:
    random = np.random.default_rng(seed)
    ids = tuple(f"8.{i + 1}" for i in range(points))
    return Performance(
        points=ids,
        neutral=random.normal(size=(points, 3)),
        time=np.cumsum(random.uniform(0.01, 0.05, frames)),
        motion=random.normal(size=(frames, points, 3)),
        sigma=random.uniform(size=(points, 3)),
        rotation=from_vector(random.normal(size=(frames, 3))),
        translation=random.normal(size=(frames, 3)),
        gaze=random.normal(size=(frames, 2, 2)),
        confidence=random.uniform(size=frames),
        lost=random.uniform(size=frames) > 0.7,
        unseen=random.normal(size=(frames, 3)),
        rest_rotation=from_vector(random.normal(size=3)),
        rest_translation=random.normal(size=3),
        spans=(Span(ids[0], ids[-1], 1, 0.125),) if points else (),
        scalars={"lid_left": random.uniform(size=frames), "tongue_out": np.zeros(frames)},
        vocabulary="arkit" if weights else "",
        shapes=random.uniform(size=(frames, weights) if weights else (0, 0)),
        source="a take, 10:15 — Zoë",
    )


def assert_same(a: Performance, b: Performance) -> None:
    for field in fields(Performance):
        left, right = getattr(a, field.name), getattr(b, field.name)
        if field.name == "scalars":
            assert left.keys() == right.keys()
            for name in left:
                np.testing.assert_array_equal(left[name], right[name])
        elif isinstance(left, np.ndarray):
            assert left.dtype == right.dtype
            np.testing.assert_array_equal(left, right)
        else:
            assert left == right


@settings(
    deadline=None, max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    frames=st.integers(0, 9),
    points=st.integers(0, 5),
    weights=st.sampled_from([0, 52]),
    seed=st.integers(0, 99),
)
def test_in_and_out_again_is_the_same_to_the_bit(
    tmp_path: Path, frames: int, points: int, weights: int, seed: int
) -> None:
    performance = make(frames, points, weights if frames else 0, seed)
    write_performance(performance, tmp_path / "take.mien")
    assert_same(read_performance(tmp_path / "take.mien"), performance)


def test_the_same_performance_gives_the_same_bytes(tmp_path: Path) -> None:
    write_performance(make(), tmp_path / "a.mien")
    write_performance(make(), tmp_path / "b.mien")
    assert (tmp_path / "a.mien").read_bytes() == (tmp_path / "b.mien").read_bytes()


def test_numpy_alone_reads_the_arrays(tmp_path: Path) -> None:
    performance = make()
    write_performance(performance, tmp_path / "take.mien")
    with np.load(tmp_path / "take.mien", allow_pickle=False) as arrays:
        np.testing.assert_array_equal(arrays["motion"], performance.motion)
        np.testing.assert_array_equal(arrays["scalars/lid_left"], performance.scalars["lid_left"])


def test_a_newer_version_says_so(tmp_path: Path) -> None:
    path = tmp_path / "take.mien"
    write_performance(make(), path)
    _edit_header(path, version=2)
    with pytest.raises(FormatError, match="update mien"):
        read_performance(path)


@pytest.mark.parametrize(
    "change",
    [
        {"frames": 8},
        {"frames": 10**12},
        {"frames": -1},
        {"frames": True},
        {"points": ["8.1", "8.1", "8.2", "8.3"]},
        {"points": ["8.1"]},
        {"points": "8.1"},
        {"weights": 4},
        {"vocabulary": ""},
        {"scalars": ["../../etc/passwd"]},
        {"spans": [{"first": "8.1", "second": "9.9", "axis": 0, "sigma": 1.0}]},
        {"spans": [{"first": "8.1", "second": "8.2", "axis": 7, "sigma": 1.0}]},
        {"spans": [{"first": "8.1", "second": "8.2", "axis": 0, "sigma": float("nan")}]},
        {"source": None},
        {"format": "something else"},
    ],
)
def test_a_header_that_lies_is_refused(tmp_path: Path, change: dict[str, object]) -> None:
    path = tmp_path / "take.mien"
    write_performance(make(), path)
    _edit_header(path, **change)
    with pytest.raises(FormatError) as caught:
        read_performance(path)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("field", ["motion", "rotation", "time", "sigma"])
def test_numbers_no_face_can_have_are_refused(tmp_path: Path, field: str) -> None:
    performance = make()
    broken = getattr(performance, field).copy()
    broken.flat[-1] = {"motion": np.nan, "rotation": 5.0, "time": 0.0, "sigma": -1.0}[field]
    write_performance(replace(performance, **{field: broken}), tmp_path / "take.mien")
    with pytest.raises(FormatError):
        read_performance(tmp_path / "take.mien")


def test_arrays_of_objects_are_never_unpickled(tmp_path: Path) -> None:
    path = tmp_path / "take.mien"
    write_performance(make(), path)
    np.save(tmp_path / "evil.npy", np.array([print] * 7, dtype=object), allow_pickle=True)
    _replace_member(path, "time.npy", (tmp_path / "evil.npy").read_bytes())
    with pytest.raises(FormatError, match="time"):
        read_performance(path)


def test_a_folder_that_is_not_there_is_an_output_error(tmp_path: Path) -> None:
    with pytest.raises(OutputError):
        write_performance(make(), tmp_path / "absent" / "take.mien")


@settings(
    deadline=None, max_examples=200, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_damage_never_ends_in_anything_but_a_plain_error(
    tmp_path: Path, data: st.DataObject
) -> None:
    path = tmp_path / "take.mien"
    if not path.exists():
        write_performance(make(), path)
    whole = path.read_bytes()
    broken = bytearray(whole[: data.draw(st.integers(0, len(whole)))])
    if len(broken) == len(whole) or data.draw(st.booleans()):
        broken = bytearray(whole)
        for _ in range(data.draw(st.integers(1, 6))):
            broken[data.draw(st.integers(0, len(broken) - 1))] ^= 1 << data.draw(st.integers(0, 7))
    hurt = tmp_path / "hurt.mien"
    hurt.write_bytes(broken)
    with suppress(FormatError):
        # What a flip leaves readable is a performance that obeys every law (dates, comments).
        read_performance(hurt)


def _edit_header(path: Path, **change: object) -> None:
    with zipfile.ZipFile(path) as archive:
        header = json.loads(archive.read(HEADER))
    _replace_member(path, HEADER, json.dumps(header | change).encode())


def _replace_member(path: Path, name: str, content: bytes) -> None:
    with zipfile.ZipFile(path) as archive:
        members = {entry: archive.read(entry) for entry in archive.namelist()}
    with zipfile.ZipFile(path, "w") as archive:
        for entry, data in (members | {name: content}).items():
            archive.writestr(entry, data)
