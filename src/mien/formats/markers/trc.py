"""TRC, the marker tracks of Motion Analysis and OpenSim: a table under a head of five lines.

    PathFileType  4  (X/Y/Z)  take.trc
    DataRate  CameraRate  NumFrames  NumMarkers  Units  OrigDataRate ...
    120       120         1200       32          mm     120 ...
    Frame#  Time  LBrowIn          RBrowIn ...
                  X1   Y1   Z1     X2   Y2   Z2 ...
    1       0.0   1.2  3.4  5.6    ...

A marker that was not seen has empty cells, or zeros.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mien.errors import FormatError
from mien.formats.markers.table import labels_of, read_lines, read_rows, take_of
from mien.formats.meshes.lengths import millimetres
from mien.performance.marker_take import MarkerTake


def read_trc(path: Path | str, units: str | None = None) -> MarkerTake:
    """Read the markers of a TRC file; ``units`` as for ``read_c3d``. Raises InputError,
    FormatError."""
    path = Path(path)
    lines = read_lines(path)
    if len(lines) < 6 or not lines[0].startswith("PathFileType"):
        raise FormatError(f"{path}: not a TRC file; its first line begins with PathFileType")
    names = lines[1].rstrip("\n").split("\t")
    head = dict(zip((n.strip() for n in names), lines[2].split("\t"), strict=False))
    labels = labels_of([cell for cell in lines[3].rstrip("\n").split("\t")[2:] if cell.strip()])
    rows = read_rows(path, lines[5:], "\t", 2 + 3 * len(labels), first=6)
    places = rows[:, 2:].reshape(len(rows), len(labels), 3)
    places[~places.any(axis=-1)] = np.nan
    unit = millimetres(path, head.get("Units", ""), units, places)
    return take_of(path, labels, rows[:, 1], _rate(head), places, unit)


def _rate(head: dict[str, str]) -> float | None:
    try:
        return float(head.get("DataRate", ""))
    except ValueError:
        return None
