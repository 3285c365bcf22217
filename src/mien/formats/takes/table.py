"""Curves as a plain table: one row a frame, one column a morph target, for any spreadsheet."""

from __future__ import annotations

import csv
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError, InputError
from mien.formats.atomic import whole_file
from mien.numeric.euler import to_euler
from mien.numeric.rotation import from_quaternion, to_quaternion
from mien.performance.curves import Curves

Array = NDArray[np.float64]

FIXED = (
    "time_s",
    "lost",
    "residual_mm",
    "head_qx",
    "head_qy",
    "head_qz",
    "head_qw",
    "head_yaw_deg",
    "head_pitch_deg",
    "head_roll_deg",
    "head_x_mm",
    "head_y_mm",
    "head_z_mm",
    "gaze_left_yaw_deg",
    "gaze_left_pitch_deg",
    "gaze_right_yaw_deg",
    "gaze_right_pitch_deg",
)
"""The first columns; the angles of the head repeat its quaternion for people. Positive angles turn
to the subject's left, up, and lean to the subject's left. Weights follow."""

MAX_FRAMES = 1_000_000
MAX_COLUMNS = 4096


def write_table(path: Path, curves: Curves) -> None:
    """Write a CSV with a header line; numbers to ten significant digits. Raises OutputError."""
    table = np.concatenate(
        [
            curves.time[:, None],
            curves.lost[:, None],
            curves.residual[:, None],
            to_quaternion(curves.rotation),
            np.degrees(to_euler(curves.rotation)),
            curves.translation,
            np.degrees(curves.gaze).reshape(-1, 4),
            curves.weights,
        ],
        axis=1,
    )
    with whole_file(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as text:
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow((*FIXED, *curves.names))
        writer.writerows([f"{value + 0.0:.10g}" for value in row] for row in table)


def read_table(path: Path) -> Curves:
    """Read such a table again; the character is called as the file is.

    Raises InputError, FormatError.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    try:
        with path.open(encoding="utf-8-sig", newline="") as text:
            names, table = _read_rows(path, csv.reader(text))
    except (UnicodeDecodeError, csv.Error) as error:
        raise FormatError(f"{path}: not a table of weights ({error})") from error
    except OSError as error:
        raise FormatError(f"{path}: cannot be read ({error.strerror})") from error
    column = {name: table[:, i] for i, name in enumerate(FIXED)}
    quaternion = table[:, 3:7]
    if not (np.abs(np.linalg.norm(quaternion, axis=1) - 1.0) < 1e-3).all():
        raise FormatError(f"{path}: head_qx to head_qw are no rotation; their length should be 1")
    if (np.diff(column["time_s"]) <= 0.0).any():
        raise FormatError(f"{path}: the times of column time_s do not increase")
    return Curves(
        character=path.stem,
        names=names,
        time=column["time_s"],
        weights=table[:, len(FIXED) :],
        rotation=from_quaternion(quaternion),
        translation=table[:, 10:13],
        gaze=np.radians(table[:, 13:17]).reshape(-1, 2, 2),
        lost=column["lost"] != 0.0,
        residual=column["residual_mm"],
    )


def _read_rows(path: Path, rows: Iterator[list[str]]) -> tuple[tuple[str, ...], Array]:
    header = next(rows, [])
    names = tuple(header[len(FIXED) :])
    if tuple(header[: len(FIXED)]) != FIXED:
        raise FormatError(f"{path}: not a table of weights; its first columns are {FIXED[0]}, ...")
    if len(header) > MAX_COLUMNS or len(set(names)) < len(names):
        raise FormatError(f"{path}: columns of the same name, or more than {MAX_COLUMNS}")
    table: list[Array] = []
    for line, row in enumerate(rows, start=2):
        try:
            values = np.array(row, dtype=float)
        except ValueError as error:
            raise FormatError(f"{path}: line {line}: {error}") from error
        if len(values) != len(header) or not np.isfinite(values).all():
            raise FormatError(f"{path}: line {line}: expected {len(header)} finite numbers")
        if len(table) == MAX_FRAMES:
            raise FormatError(f"{path}: more than {MAX_FRAMES} rows; split the table")
        table.append(values)
    return names, np.array(table).reshape(-1, len(header))
