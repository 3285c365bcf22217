"""The faces of a performer that stand for faces of a character, in a file.

[[example]]
seconds = 3.2                    # of the take
pose = { smile = 1.0 }           # key models of the character, and how far
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mien.errors import FormatError
from mien.formats.notes.toml import number, read_toml

Pair = tuple[float, Mapping[str, float]]

_MOST = 1000
_FARTHEST = 1e6


def read_pairs(path: Path) -> tuple[Pair, ...]:
    """(seconds, pose) of each example. Raises InputError, FormatError."""
    listed = read_toml(path).get("example")
    if not isinstance(listed, list) or not 0 < len(listed) <= _MOST:
        raise FormatError(f"{path}: has no [[example]]; write seconds = and pose = under it")
    return tuple(_pair(path, given) for given in listed)


def _pair(path: Path, given: Any) -> Pair:
    pose = given.get("pose") if isinstance(given, dict) else None
    seconds = number(given.get("seconds"), 0.0, _FARTHEST) if isinstance(given, dict) else None
    if seconds is None or not isinstance(pose, dict) or not pose:
        raise FormatError(f"{path}: an example is 'seconds = 3.2' and 'pose = {{ smile = 1.0 }}'")
    levels = {name: number(level, 0.0, 2.0) for name, level in pose.items()}
    found = {name: level for name, level in levels.items() if level is not None}
    if len(found) < len(levels):
        raise FormatError(f"{path}: the weights of a pose go from 0 to 2")
    return seconds, found
