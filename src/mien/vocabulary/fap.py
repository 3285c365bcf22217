"""The 68 facial animation parameters of MPEG-4 (FAP), by number. Sides are the subject's.

A value counts 1/1024 of a length of the face (vocabulary.fapu), or 1e-5 radians. FAPs 3 to 68 each
move one thing; FAPs 1 and 2 name visemes and expressions, which become values of the others here.
A table of values has 66 columns, FAPs 3 to 68 in their order.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mien.numeric.euler import from_euler, to_euler
from mien.vocabulary.fapu import Fapu

Array = NDArray[np.float64]

FIRST, LAST = 3, 68
"""The FAPs that move one thing each."""
PER_UNIT = 1024.0
PER_RADIAN = 1e5
STRONGEST = 63.0
"""Blend of visemes and intensity of expressions run from 0 to this."""
_AXES = {"x": 0, "y": 1, "z": 2}
_HEAD, _HEAD_SIGNS = (49, 48, 50), (1.0, -1.0, -1.0)
"""Yaw to the left, pitch down, roll to the right; ours are positive up and to the left."""
_GAZE, _GAZE_SIGNS = (23, 25, 24, 26), (1.0, -1.0, 1.0, -1.0)
"""Yaw to the left and pitch down of the left, then the right eye."""


@dataclass(frozen=True, slots=True)
class Fap:
    """One parameter of the standard."""

    number: int
    name: str
    what_it_does: str
    unit: str
    """IRISD, ES, ENS, MNS, MW, AU (1e-5 radians) or empty (1 and 2)."""
    motion: str
    """"+x" and so on along an axis, "turn +x" about one, "widen", "curl" or "compound"."""
    point: str
    """The FDP point it moves; the pupil of the eye, the top of the spine of the head it turns."""
    mirror: int
    """The FAP that does the same on the other side; itself where there is one for both."""
    mirror_sign: int
    """-1 where the mirrored movement has the other sign."""
    lower: float
    upper: float
    """What faces can do, not what the standard's coder can write."""

    @property
    def group(self) -> int:
        """1 visemes and expressions, 2 jaw and inner lips, 3 eyes, 4 brows, 5 cheeks, 6 tongue,
        7 head, 8 outer lips, 9 nose, 10 ears."""
        return int(self.point.partition(".")[0]) if self.point else 1

    @property
    def axis(self) -> int | None:
        """Head-frame axis along which the point moves; None where it does not."""
        return _AXES[self.motion[1]] if self.motion[0] in "+-" else None

    @property
    def sign(self) -> float:
        """Of the motion along or about its axis."""
        return -1.0 if "-" in self.motion else 1.0

    @property
    def reach(self) -> float:
        """The farthest it goes, in either direction."""
        return max(-self.lower, self.upper)

    def size(self, fapu: Fapu) -> float:
        """Millimetres, or radians, of a value of 1."""
        if self.unit == "AU":
            return 1.0 / PER_RADIAN
        lengths = {
            "IRISD": fapu.iris,
            "ES": fapu.eyes,
            "ENS": fapu.nose,
            "MNS": fapu.philtrum,
            "MW": fapu.mouth,
        }
        return lengths[self.unit] / PER_UNIT


@cache
def faps() -> Mapping[int, Fap]:
    """All 68 by number."""
    return MappingProxyType(
        {
            int(row["number"]): Fap(
                number=int(row["number"]),
                name=row["name"],
                what_it_does=row["what_it_does"],
                unit=row["unit"],
                motion=row["motion"],
                point=row["point"],
                mirror=int(row["mirror"]),
                mirror_sign=int(row["mirror_sign"]),
                lower=float(row["lower"]),
                upper=float(row["upper"]),
            )
            for row in _rows("fap.csv")
        }
    )


def simple() -> tuple[Fap, ...]:
    """(66) FAPs 3 to 68: the columns of a table of values."""
    return tuple(faps()[number] for number in range(FIRST, LAST + 1))


def names() -> tuple[str, ...]:
    """(66) their names: the columns of ``Performance.shapes`` for "fap"."""
    return tuple(fap.name for fap in simple())


def column(number: int) -> int:
    """Column of FAP ``number`` (3 to 68) in a table of values."""
    return number - FIRST


def mirrored(values: ArrayLike) -> Array:
    """Values (..., 66) of the same face seen in a mirror."""
    columns = [column(fap.mirror) for fap in simple()]
    signs = np.array([fap.mirror_sign for fap in simple()], dtype=float)
    return np.asarray(np.asarray(values, dtype=float)[..., columns] * signs)


@cache
def visemes() -> Mapping[str, Array]:
    """(66,) values of the visemes 1 to 14 of FAP 1, named by their first sound."""
    return _compounds("viseme")


@cache
def expressions() -> Mapping[str, Array]:
    """(66,) values of the expressions 1 to 6 of FAP 2: joy, sadness, anger, fear, disgust,
    surprise."""
    return _compounds("expression")


def viseme_values(first: ArrayLike, second: ArrayLike, blend: ArrayLike) -> Array:
    """(F, 66) of FAP 1: viseme ``first`` (F,) as far as ``blend`` (F,) of 63 says, ``second`` for
    the rest; 0 is none."""
    share = np.asarray(blend, dtype=float)[..., None] / STRONGEST
    table = _numbered(visemes())
    return np.asarray(share * table[np.asarray(first)] + (1.0 - share) * table[np.asarray(second)])


def expression_values(
    first: ArrayLike, intensity: ArrayLike, second: ArrayLike, second_intensity: ArrayLike
) -> Array:
    """(F, 66) of FAP 2: two expressions (F,), 0 is none, each at its intensity (F,) of 63."""
    table = _numbered(expressions())
    one, two = (
        np.asarray(level, dtype=float)[..., None] / STRONGEST
        for level in (intensity, second_intensity)
    )
    return np.asarray(one * table[np.asarray(first)] + two * table[np.asarray(second)])


def head_and_gaze(values: Array) -> tuple[Array, Array]:
    """Rotation (F, 3, 3) of the head and gaze (F, 2, 2), as in Performance, of values (F, 66).

    The standard does not say in which order the angles of the head follow: here as in
    numeric.euler, so that a yaw turns a head that nods already.
    """
    angles = values[:, [column(number) for number in _HEAD]] / PER_RADIAN
    gaze = values[:, [column(number) for number in _GAZE]] / PER_RADIAN
    return from_euler(angles * _HEAD_SIGNS), (gaze * _GAZE_SIGNS).reshape(-1, 2, 2)


def with_head_and_gaze(values: Array, rotation: Array, gaze: Array) -> Array:
    """``values`` (F, 66) with the angles of ``rotation`` (F, 3, 3) and ``gaze`` (F, 2, 2)."""
    full = values.copy()
    full[:, [column(number) for number in _HEAD]] = to_euler(rotation) * _HEAD_SIGNS * PER_RADIAN
    full[:, [column(number) for number in _GAZE]] = gaze.reshape(-1, 4) * _GAZE_SIGNS * PER_RADIAN
    return full


def _numbered(table: Mapping[str, Array]) -> Array:
    return np.stack([np.zeros(LAST - FIRST + 1), *table.values()])


def _compounds(kind: str) -> Mapping[str, Array]:
    found = {}
    for row in _rows("fap_compounds.csv"):
        if row["kind"] == kind:
            values = np.zeros(LAST - FIRST + 1)
            for given in row["faps"].split():
                number, _, value = given.partition(":")
                values[column(int(number))] = float(value)
            found[row["name"]] = values
    return MappingProxyType(found)


def _rows(file: str) -> Iterator[dict[str, str]]:
    text = resources.files("mien.vocabulary").joinpath("data", file).read_text("utf-8")
    return csv.DictReader(line for line in text.splitlines() if not line.startswith("#"))
