"""The performer file: whole, or refused in one line."""

from __future__ import annotations

import io
import json
import zipfile
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mien.errors import FormatError, InputError
from mien.formats.notes.rectangles import read_rectangles
from mien.formats.performer_file import read_performer, write_performer
from mien.performance.performer import HeldFace, Performer


def some_performer() -> Performer:
    random = np.random.default_rng(1)
    return Performer(
        landmarks={"focal": np.array(700.5), "model": random.normal(size=(7, 3))},
        curves={"rest": random.normal(size=(5, 6, 2))},
        poses={"snakes/smile": random.normal(size=(20, 3))},
        source="one.mp4, two.mp4",
        held=(
            HeldFace(
                "landmarks",
                "man",
                {"smile": 1.0, "jaw_open": 0.4},
                random.normal(size=(7, 3)),
                np.array([0.0, 0.0, 1.0]),
                np.array([0.1, 0.9]),
            ),
        ),
    )


def test_what_is_written_is_read_to_the_bit(tmp_path: Path) -> None:
    path = tmp_path / "me.performer"
    one = some_performer()
    write_performer(one, path)
    two = read_performer(path)
    assert two.source == one.source
    for section in ("landmarks", "curves", "poses"):
        first, second = getattr(one, section), getattr(two, section)
        assert set(first) == set(second)
        assert all(np.array_equal(first[name], second[name]) for name in first)
        assert all(first[name].shape == second[name].shape for name in first)
    (held,), (found,) = one.held, two.held
    assert (held.capture, held.character, held.pose) == (found.capture, found.character, found.pose)
    for name in ("motion", "unseen", "lids"):
        assert np.array_equal(getattr(held, name), getattr(found, name))


@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(data=st.data())
def test_damage_is_refused_and_never_a_traceback(
    tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    path = tmp_path_factory.getbasetemp() / "damaged.performer"
    write_performer(some_performer(), path)
    whole = bytearray(path.read_bytes())
    if data.draw(st.booleans()):
        whole = whole[: data.draw(st.integers(0, len(whole) - 1))]
    else:
        for _ in range(data.draw(st.integers(1, 6))):
            at = data.draw(st.integers(0, len(whole) - 1))
            whole[at] ^= 1 << data.draw(st.integers(0, 7))
    path.write_bytes(bytes(whole))
    with suppress(FormatError):
        read_performer(path)


def forged(path: Path, header: object, arrays: dict[str, bytes] | None = None) -> Path:
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("mien.json", json.dumps(header))
        for name, data in (arrays or {}).items():
            archive.writestr(name, data)
    return path


def header(arrays: object, **more: object) -> dict[str, object]:
    return {"format": "mien performer", "version": 1, "source": "", "arrays": arrays, **more}


@pytest.mark.parametrize(
    "wrong",
    [
        [],
        {"format": "mien performance"},
        header({}, version=2),
        header({}, source=7),
        header({"rest": [1]}),
        header({"nowhere/rest": [1]}),
        header({"curves/rest": [-1]}),
        header({"curves/rest": "large"}),
        header({"curves/rest": [1 << 30, 1 << 30]}),
        header({f"curves/{i}": [1 << 20] for i in range(9)}),
        header({f"curves/{i}": [] for i in range(600)}),
        header({"curves/rest": [2]}),
    ],
)
def test_headers_that_lie_are_refused(tmp_path: Path, wrong: object) -> None:
    with pytest.raises(FormatError):
        read_performer(forged(tmp_path / "me.performer", wrong))


def test_numbers_that_are_none_are_refused(tmp_path: Path) -> None:
    stream = io.BytesIO()
    np.save(stream, np.array([1.0, np.nan]))
    path = forged(
        tmp_path / "me.performer",
        header({"curves/rest": [2]}),
        {"curves/rest.npy": stream.getvalue()},
    )
    with pytest.raises(FormatError, match="not finite"):
        read_performer(path)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_performer(tmp_path / "nobody.performer")


def test_rectangles_are_read(tmp_path: Path) -> None:
    path = tmp_path / "features.csv"
    path.write_text("# mine\nseconds,feature,left,top,right,bottom\n0.5, lips,1,2,30,14.5\n")
    found = read_rectangles(path, ("lips",))
    assert found[0.5]["lips"].tolist() == [1.0, 2.0, 30.0, 14.5]


@pytest.mark.parametrize(
    "text",
    ["", "1,nose,1,2,3,4", "1,lips,1,2,3", "1,lips,5,2,3,4", "x,lips,1,2,3,4", "1,lips,1,2,nan,4"],
)
def test_rectangles_that_are_none_are_refused(tmp_path: Path, text: str) -> None:
    path = tmp_path / "features.csv"
    path.write_text(text)
    with pytest.raises(FormatError, match=r"features\.csv"):
        read_rectangles(path, ("lips",))
