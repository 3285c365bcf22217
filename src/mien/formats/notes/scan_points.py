"""Feature points of a scan as a small file that people correct.

scan = "neutral.ply"      beside this file
found = true              by the detector; false once they have been corrected
[points]                  in the scan's own axes and unit, as a mesh viewer shows them
"8.3" = [25.91, -43.02, 92.4]
"""

from __future__ import annotations

import math
import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError, InputError
from mien.formats.atomic import whole_file
from mien.vocabulary.fdp import feature_points

MAX_BYTES = 1 << 20
_HEAD = """\
# Feature points of a scan, to be corrected where they are off (the picture beside this file shows
# them). Each is an MPEG-4 point, in the scan's own axes and unit; left is the subject's. Delete a
# point that cannot be seen. After correcting say found = false: then they are believed.
"""


@dataclass(frozen=True, slots=True)
class PointsFile:
    """What the file tells."""

    scan: str
    """Name of the scan's file, in the same folder."""
    found: bool
    """Whether nobody has corrected them."""
    ids: tuple[str, ...]
    """(N) FDP ids."""
    places: NDArray[np.float64]
    """(N, 3) in the scan's axes and unit."""


def write_points(path: Path, points: PointsFile) -> None:
    """Write points. Raises OutputError."""
    places = dict(feature_points())
    lines = [_HEAD, f'scan = "{_quoted(points.scan)}"', f"found = {str(points.found).lower()}", ""]
    lines.append("[points]")
    for name, place in zip(points.ids, points.places, strict=True):
        numbers = ", ".join(f"{value:.6g}" for value in place)
        lines.append(f'"{name}" = [{numbers}]  # {places[name].place}')
    with whole_file(path) as temporary:
        temporary.write_text("\n".join(lines) + "\n", encoding="utf-8")


def read_points(path: Path) -> PointsFile:
    """Read points. Raises InputError where there is no file, FormatError."""
    try:
        if path.stat().st_size > MAX_BYTES:
            raise FormatError(f"{path}: too large for a list of feature points")
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    except (UnicodeDecodeError, tomllib.TOMLDecodeError, RecursionError) as error:
        raise FormatError(f"{path}: not a table of points ({error})".replace("\n", " ")) from error
    scan, found, points = table.get("scan", ""), table.get("found", False), table.get("points")
    if not isinstance(points, dict) or not isinstance(scan, str) or not isinstance(found, bool):
        raise FormatError(
            f"{path}: no [points], or scan and found are not a name and true or false"
        )
    known = feature_points()
    for name, place in points.items():
        if name not in known:
            raise FormatError(f"{path}: '{name[:20]}' is no feature point of MPEG-4 such as 8.3")
        if not (isinstance(place, list) and len(place) == 3 and all(map(_number, place))):
            raise FormatError(f"{path}: point {name} is not three numbers [x, y, z]")
    places = np.array(list(points.values()), dtype=float).reshape(-1, 3)
    return PointsFile(scan, found, tuple(points), places)


def _number(value: object) -> bool:
    if isinstance(value, bool) or not isinstance(value, int | float):
        return False
    return math.isfinite(value) and abs(value) < 1e9


def _quoted(name: str) -> str:
    plain = "".join(c if c.isprintable() else "?" for c in name)
    return plain.replace("\\", "\\\\").replace('"', '\\"')
