"""Marker takes by their ending. To add a kind, write a module and one line."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path

from mien.errors import InputError
from mien.formats.markers.c3d import read_c3d
from mien.formats.markers.csv import names_markers, read_marker_csv
from mien.formats.markers.trc import read_trc
from mien.performance.marker_take import MarkerTake

READERS: Mapping[str, Callable[[Path, str | None], MarkerTake]] = {
    ".c3d": read_c3d,
    ".trc": read_trc,
    ".csv": read_marker_csv,
}
_LONGEST_HEADER = 2**20


def holds_markers(path: str | Path) -> bool:
    """Whether a file is a marker take: by its ending, and by the first line of a .csv, which may
    be many things."""
    path = Path(path)
    ending = path.suffix.lower()
    if ending != ".csv":
        return ending in READERS
    try:
        with path.open("rb") as file:
            return names_markers(file.readline(_LONGEST_HEADER).decode("utf-8-sig", "replace"))
    except OSError:
        return False


def read_markers(path: str | Path, units: str | None = None) -> MarkerTake:
    """Read a marker take; ``units`` of its numbers where it does not name them. Raises InputError,
    FormatError."""
    path = Path(path)
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    return READERS[path.suffix.lower()](path, units)


def read_roles(path: str | Path) -> dict[str, str]:
    """What the user says of labels: lines "LABEL,8.3", "LABEL,jig" or "LABEL,-"; # comments.

    Raises InputError for a file that cannot be read or a line of another kind.
    """
    path = Path(path)
    try:
        lines = path.read_text("utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"--labels {path}: cannot be read ({error})") from error
    roles = {}
    for number, line in enumerate(lines, start=1):
        words = [word.strip() for word in line.partition("#")[0].split(",")]
        if words == [""]:
            continue
        if len(words) != 2 or not all(words):
            raise InputError(f"--labels {path}: line {number} is not LABEL,FDP such as LBrowIn,4.1")
        roles[words[0]] = words[1]
    return roles
