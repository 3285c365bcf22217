"""The wires of a character's key models in a file: drag a control point by writing another place.

[smile]
"8.3" = [6.1, 5.2, -2.0]         # mm from rest: to the subject's left, up, out of the face
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from mien.errors import FormatError
from mien.face.face import Array
from mien.formats.atomic import whole_file
from mien.formats.notes.toml import number, read_toml

Wired = Mapping[str, Mapping[str, Array]]
"""Key model -> FDP id -> displacement (3,) mm of a control point."""

_FARTHEST = 1e3


def write_wires(path: Path, wired: Wired) -> None:
    """Write the control points of key models. Raises OutputError."""
    lines = [
        "# Control points of wires, mm from rest: to the subject's left, up, out of the face.\n"
    ]
    for key, points in wired.items():
        lines.append(f"\n[{_quoted(key)}]\n")
        for fdp, moved in points.items():
            lines.append(f'"{fdp}" = [{", ".join(f"{x:.4f}" for x in moved)}]\n')
    with whole_file(path) as file:
        file.write_text("".join(lines), "utf-8")


def read_wires(path: Path) -> Wired:
    """Read them. Raises InputError, FormatError."""
    found: dict[str, dict[str, Array]] = {}
    for key, points in read_toml(path).items():
        if not isinstance(points, dict):
            raise FormatError(
                f"{path}: '{key[:40]}' is no [key model] with control points under it"
            )
        found[key] = {}
        for fdp, place in points.items():
            numbers = [number(x, -_FARTHEST, _FARTHEST) for x in place] if _is_list(place) else []
            if len(numbers) != 3 or None in numbers:
                raise FormatError(f"{path}: [{key[:40]}] '{fdp[:20]}' is not at [x, y, z] mm")
            found[key][fdp] = np.array(numbers, dtype=float)
    return found


def _is_list(value: object) -> bool:
    return isinstance(value, list) and len(value) == 3


def _quoted(name: str) -> str:
    escaped = name.replace("\\", "\\\\").replace('"', '\\"')
    return f'"{escaped}"'
