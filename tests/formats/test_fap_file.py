"""``.fap`` files of every dialect: out and in again to the bit, damage told in one line."""

from __future__ import annotations

import os
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mien.errors import FormatError, InputError
from mien.formats.takes.fap import Dialect, FapTake, read_take, simple_take, write_take

DIALECTS = {
    "visage": Dialect(),
    "xface": Dialect(line_end="\r\n"),
    "greta": Dialect(tokens=69, short=True),
    "semaine": Dialect(header=False),
}
XFACE = (
    "2.1 C:\\Users\\me\\My FAPs\\TempFile 25 2\r\n"
    "0 0 1 1 " + "0 " * 64 + "\r\n0 0 10 \r\n"
    "0 0 1 1 " + "0 " * 64 + "\r\n1 5 -870 \r\n"
)
GRETA = "2.1 AU Interpolation_1131.fap 25 1\n1 " + "0 " * 17 + "1 " + "0 " * 50 + "\n0 7 626 \n"
SEMAINE = "0 0 " + "1 " * 66 + "\n0 " + "0 " * 66 + "\n0 0 0 1 " + "0 " * 64 + "\n1 -20 \n"
VISAGE = (
    "# made by hand\n2.1 talk 30 2\n1 1 1 " + "0 " * 65 + "# a mask\n"
    "0 10 0 63 0 1 32 4 16 0 0 250.5\n\n1 0 1 " + "0 " * 65 + "\n1 14 10 20 1 -3\n"
)


def take(frames: int = 4, seed: int = 0, *, short: bool = False, whole: bool = True) -> FapTake:
    """A mask that changes, and values only where it is on."""
    random = np.random.default_rng(seed)
    mask = random.random((frames, 68)) < 0.6
    values = random.normal(0.0, 400.0, (frames, 68))
    values = np.rint(values) if whole else values
    compounds = not short
    return FapTake(
        rate=float(random.integers(1, 120)),
        number=np.cumsum(random.integers(1, 4, frames)),
        mask=mask,
        values=np.where(mask & ((np.arange(68) > 1) | short), values, 0.0),
        viseme=mask[:, :1] * random.integers(0, 15, (frames, 4)) * float(compounds),
        expression=mask[:, 1:2] * random.integers(0, 7, (frames, 6)) * float(compounds),
        name="a name\\with blanks",
    )


def same(a: FapTake, b: FapTake) -> None:
    for field in ("number", "mask", "values", "viseme", "expression"):
        np.testing.assert_array_equal(getattr(a, field), getattr(b, field))


@pytest.mark.parametrize("dialect", DIALECTS)
@settings(
    deadline=None, max_examples=20, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(frames=st.integers(1, 6), seed=st.integers(0, 999), whole=st.booleans())
def test_out_and_in_again_is_the_same_to_the_bit(
    tmp_path: Path, dialect: str, frames: int, seed: int, whole: bool
) -> None:
    how = DIALECTS[dialect]
    wanted = take(frames, seed, short=how.short, whole=whole)
    write_take(tmp_path / "take.fap", wanted, how)
    found = read_take(tmp_path / "take.fap")
    same(found, wanted)
    if how.header:
        assert (found.rate, found.name) == (wanted.rate, wanted.name)
    write_take(tmp_path / "again.fap", replace(found, name=wanted.name, rate=wanted.rate), how)
    assert (tmp_path / "again.fap").read_bytes() == (tmp_path / "take.fap").read_bytes()


def test_what_other_programs_write_is_read(tmp_path: Path) -> None:
    path = tmp_path / "take.fap"
    path.write_bytes(XFACE.encode())
    found = read_take(path)
    assert (found.name, found.rate) == ("C:\\Users\\me\\My FAPs\\TempFile", 25.0)
    assert found.values[:, [2, 3]].tolist() == [[0, 10], [5, -870]]
    path.write_bytes(GRETA.encode())
    found = read_take(path)
    assert found.name == "AU Interpolation_1131.fap"
    assert (found.values[0, 0], found.values[0, 18]) == (7, 626)
    path.write_bytes(SEMAINE.encode())
    found = read_take(path)
    assert (found.rate, found.name) == (25.0, "")
    assert found.mask.sum(axis=1).tolist() == [66, 1]
    assert found.values[1, 3] == -20
    path.write_bytes(VISAGE.encode())
    found = read_take(path)
    assert found.viseme[0].tolist() == [10, 0, 63, 0]
    assert found.expression[0].tolist() == [1, 32, 4, 16, 0, 0]
    assert found.values[0, 2] == 250.5
    assert found.viseme[1].tolist() == [14, 10, 20, 1]


def test_frames_are_ordered_by_number_and_the_headers_count_is_not_believed(
    tmp_path: Path,
) -> None:
    lines = XFACE.replace("25 2", "25 2147483647").split("\r\n")
    path = tmp_path / "take.fap"
    path.write_text("\n".join([lines[0], *lines[3:5], *lines[1:3]]))
    found = read_take(path)
    assert found.number.tolist() == [0, 1]
    assert found.values[:, 3].tolist() == [10, -870]


def test_values_become_a_take_of_whole_numbers_at_a_steady_rate() -> None:
    time = np.array([0.0, 0.04, 0.12, 0.16]) + 3.0
    values = np.zeros((4, 66))
    values[:, 0] = [0.0, 10.4, 30.0, 40.0]
    found = simple_take(time, values)
    assert (found.rate, found.number.tolist()) == (25.0, [0, 1, 2, 3, 4])
    assert found.values[:, 2].tolist() == [0, 10, 20, 30, 40]
    assert found.mask[:, 2:].all()
    assert not found.mask[:, :2].any()
    assert len(simple_take(np.zeros(1), np.zeros((1, 66))).number) == 1


MASK = "0 0 1 1 " + "0 " * 64


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "empty"),
        ("2.1 x 25 9\n", "no frames"),
        ("dear diary\n" + MASK + "\n0 1 2\n", "not a .fap file"),
        ("2.1 x nan 1\n" + MASK + "\n0 1 2\n", "frames a second"),
        ("2.1 x 0 1\n" + MASK + "\n0 1 2\n", "frames a second"),
        (MASK + "\n0 1 2\n0 0 1 1\n1 1 2\n", "line 3: 4 tokens"),
        (MASK + "1 1\n0 1 2\n", "not a .fap file"),
        ("2.1 x 25 1\n" + MASK + "1\n0 1 2\n", "token 69 is 1"),
        (MASK + "\n0 1\n", "line 2: 1 values for a mask of 2"),
        (MASK + "\n0 1 2 3\n", "line 2: 3 values"),
        ("1 " + "0 " * 67 + "\n0 1 2\n", "2 values for a mask of 1"),
        ("1 " + "0 " * 67 + "\n0 15 0 63 0\n", "numbered from 0 to 14"),
        ("0 1 " + "0 " * 66 + "\n0 1 63 -1 0 0 0\n", "numbered from 0 to 6"),
        (MASK + "\n0 1 nan\n", "not finite"),
        (MASK + "\n0 1 inf\n", "not finite"),
        (MASK + "\n0 1 1e300\n", "beyond"),
        (MASK + "\n0 1 x\n", "line 2"),
        (MASK + "\n-1 1 2\n", "out of bounds"),
        (MASK + "\n99999999999 1 2\n", "out of bounds"),
        (MASK + "\n0.5 1 2\n", "line 2"),
        (MASK + "\n0 1 2\n" + MASK + "\n0 1 2\n", "frame 0 is there twice"),
        (MASK + "\n0 1 2\n" + MASK + "\n", "cut off"),
        ("0 " * 20000, "longer than any frame"),
    ],
)
def test_damage_is_told_with_its_line(tmp_path: Path, text: str, told: str) -> None:
    path = tmp_path / "take.fap"
    path.write_text(text)
    with pytest.raises(FormatError) as error:
        read_take(path)
    assert told in str(error.value)
    assert str(error.value).startswith(f"{path}: ")
    assert "\n" not in str(error.value)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_take(tmp_path / "absent.fap")


def test_compounds_in_full_cannot_be_one_value(tmp_path: Path) -> None:
    full = replace(take(2), viseme=np.ones((2, 4)))
    with pytest.raises(ValueError, match="one value"):
        write_take(tmp_path / "x.fap", full, Dialect(short=True))
    assert not list(tmp_path.iterdir())


@settings(
    deadline=None, max_examples=150, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(data=st.data())
def test_nothing_but_a_plain_error_comes_of_damage(tmp_path: Path, data: st.DataObject) -> None:
    whole = bytearray(data.draw(st.sampled_from([XFACE, GRETA, SEMAINE, VISAGE])).encode())
    for _ in range(data.draw(st.integers(1, 6))):
        whole[data.draw(st.integers(0, len(whole) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path / "take.fap"
    path.write_bytes(whole[: data.draw(st.integers(0, len(whole)))])
    with suppress(FormatError):
        found = read_take(path)
        assert np.isfinite(found.values).all()


@pytest.mark.skipif("MIEN_TEST_DATA" not in os.environ, reason="MIEN_TEST_DATA names no takes")
def test_files_in_use_come_back_to_the_bit(tmp_path: Path) -> None:
    files = sorted(Path(os.environ["MIEN_TEST_DATA"], "fap").glob("*.fap"))
    assert files
    for file in files:
        found = read_take(file)
        short = bool(found.mask[:, :2].any()) and not found.viseme.any()
        write_take(tmp_path / file.name, found, Dialect(tokens=69, short=short))
        same(read_take(tmp_path / file.name), found)
