"""The few feature points a user gives, in a file beside the character.

[points]
"9.3" = [0.0, 45.4, 94.7]     # MPEG-4 number: place in the character's own coordinates
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from mien.errors import FormatError, InputError
from mien.face.face import Array
from mien.formats.atomic import whole_file
from mien.formats.notes.toml import read_toml
from mien.vocabulary.fdp import feature_points

Picks = Mapping[str, Array]

NEEDED = (
    ("3.7", "3.12"),
    ("3.11", "3.8"),
    ("8.3", "8.4"),
    ("9.3", "9.15"),
    ("8.1", "2.2"),
    ("8.2", "2.3"),
    ("2.1", "2.10"),
)
"""One of each pair at least: corners of an eye and the mouth, nose, lips, chin."""


def read_picks(path: Path) -> Picks:
    """FDP ids and their places (3,). Raises InputError, FormatError."""
    found = read_toml(path).get("points")
    if not isinstance(found, dict) or not found:
        raise FormatError(f'{path}: has no [points]; write "9.3" = [x, y, z] under it')
    known = feature_points()
    for name, place in found.items():
        if name not in known:
            raise FormatError(f"{path}: '{name[:40]}' is no feature point; they are called '9.3'")
        if not _is_place(place):
            raise FormatError(f"{path}: '{name}' is not at [x, y, z]")
    require(found, str(path))
    return {name: np.array(place, dtype=float) for name, place in found.items()}


def write_picks(path: Path, picks: Mapping[str, Sequence[float]]) -> None:
    """Write what ``read_picks`` reads. Raises InputError where it would refuse it, OutputError."""
    known = feature_points()
    lines = ["# Feature points (MPEG-4 numbers) in the file's own coordinates.", "", "[points]"]
    for name, place in picks.items():
        if name not in known or not _is_place(list(place)):
            raise InputError(f"'{name[:40]}' is no feature point, or not at x, y, z")
        numbers = ", ".join(repr(float(x)) for x in place)
        lines.append(f'"{name}" = [{numbers}] # {known[name].place}')
    require(picks, path.name)
    with whole_file(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")


def require(found: Mapping[str, object], where: str) -> None:
    """Raise InputError where a point is missing without which no face can be measured."""
    for pair in NEEDED:
        if not any(name in found for name in pair):
            place = feature_points()[pair[0]].place
            raise InputError(f"{where}: {' or '.join(pair)} is missing ({place})")


def _is_place(place: object) -> bool:
    return (
        isinstance(place, list)
        and len(place) == 3
        and all(type(x) in (int, float) and math.isfinite(x) and abs(x) < 1e7 for x in place)
    )
