"""Markers as a plain table: a column a coordinate, a row a frame.

    time,LBrowIn.x,LBrowIn.y,LBrowIn.z,RBrowIn.x,...

The coordinate may be parted from the name by a dot, colon, underscore or blank, and may be followed
by the unit: ``LBrowIn.x (mm)``. Times are seconds. A marker that was not seen has empty cells.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from mien.errors import FormatError
from mien.formats.markers.table import labels_of, read_lines, read_rows, take_of
from mien.formats.meshes.lengths import millimetres
from mien.performance.marker_take import MarkerTake

_COLUMN = re.compile(r"(.+?)[.:_ ]([xyzXYZ])(?:\s*\((\w+)\))?")


def names_markers(header: str) -> bool:
    """Whether a table's first line is that of markers: time, and three coordinates of each."""
    cells = [cell.strip().strip('"') for cell in header.strip().split(",")]
    columns = [_COLUMN.fullmatch(cell) for cell in cells[1:]]
    axes = [column.group(2).lower() if column else "" for column in columns]
    return (
        cells[0].lower() in ("time", "time_s")
        and len(axes) > 0
        and axes == list("xyz") * (len(axes) // 3)
    )


def read_marker_csv(path: Path | str, units: str | None = None) -> MarkerTake:
    """Read a table of markers; ``units`` of its numbers, where no column says "(mm)". Raises
    InputError, FormatError."""
    path = Path(path)
    lines = read_lines(path)
    if not lines or not names_markers(lines[0]):
        raise FormatError(f"{path}: not a table of markers: time,NAME.x,NAME.y,NAME.z,...")
    columns = [_COLUMN.fullmatch(cell.strip().strip('"')) for cell in lines[0].split(",")[1:]]
    known = [column for column in columns if column]
    labels = labels_of([column.group(1) for column in known[::3]])
    rows = read_rows(path, lines[1:], ",", 1 + 3 * len(labels), first=2)
    places = rows[:, 1:].reshape(len(rows), len(labels), 3)
    places[~places.any(axis=-1)] = np.nan
    unit = millimetres(path, known[0].group(3) or "", units, places)
    return take_of(path, labels, rows[:, 0], None, places, unit)
