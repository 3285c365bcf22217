"""Recorded takes of Live Link Face: a CSV of ARKit weights, head and eye angles.

Its angles are radians: yaw positive to the subject's right, pitch positive down, roll positive
leaning to the subject's left. For the eyes that was measured in two takes (yaw goes with the looks
to the right, pitch with the looks down, 0.99); for the head it is what the same Unreal rotation of
a face seen from the front means, and head and eyes turn together in the one take that has both.
"""

from __future__ import annotations

import csv
import re
from array import array
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError, InputError
from mien.formats.atomic import whole_file
from mien.numeric.euler import from_euler, to_euler
from mien.performance.performance import Performance
from mien.vocabulary.arkit import names, pascal
from mien.vocabulary.livelink import ANGLES, FRAMES_PER_SECOND, SIDEWAYS, csv_columns

Array = NDArray[np.float64]

MAX_FRAMES = 1_000_000
MAX_COLUMNS = 256
LARGEST = 10.0
"""Weights reach 1.05 in real takes and angles a few radians; degrees and garbage reach more."""

TICKS = 1000 * FRAMES_PER_SECOND
"""Of a time code, a second: it counts thousandths of a frame."""
_DAY = 24 * 3600 * TICKS

_TIMECODE = re.compile(r"(\d{1,2}):(\d{2}):(\d{2})[:;](\d{2})(?:\.(\d{3}))?", re.ASCII)

_LOOK = 0.6
"""Radians of an eye at a look weight of 1, where a take has weights but no angles (as fitted on
two takes that have both: 0.59 to 0.61 for yaw, 0.53 to 0.61 for pitch)."""


def read_livelink(path: Path, swap_sideways: bool = False) -> Performance:
    """Read a take as weights of the vocabulary "arkit", with head and gaze; it has no points.

    Columns are bound by name, whatever their order. ``swap_sideways`` exchanges jaw and mouth
    left and right, which some versions of the app name the wrong way round. A row whose count is
    0 is a frame in which no face was seen. Raises InputError, FormatError.
    """
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    try:
        with path.open(encoding="utf-8-sig", newline="") as text:
            ticks, values, lost, columns = _read_rows(path, csv.reader(text))
    except (UnicodeDecodeError, csv.Error) as error:
        raise FormatError(f"{path}: not a Live Link Face CSV ({error})") from error
    except OSError as error:
        raise FormatError(f"{path}: cannot be read ({error.strerror})") from error
    shapes = values[:, [columns[pascal(name)] for name in swapped_names(swap_sideways)]]
    angles = np.zeros((len(values), len(ANGLES)))
    for i, name in enumerate(ANGLES):
        if name in columns:
            angles[:, i] = values[:, columns[name]]
    frames = len(values)
    return Performance(
        points=(),
        neutral=np.zeros((0, 3)),
        time=(ticks - ticks[0]) / TICKS,
        motion=np.zeros((frames, 0, 3)),
        sigma=np.zeros((0, 3)),
        rotation=from_euler(angles[:, :3] * (-1.0, -1.0, 1.0)),
        translation=np.zeros((frames, 3)),
        gaze=_gaze(angles, shapes),
        confidence=np.where(lost, 0.0, 1.0),
        lost=lost,
        unseen=np.zeros((frames, 3)),
        vocabulary="arkit",
        shapes=shapes,
        source=f"Live Link Face take {path.name}",
    )


def write_livelink(path: Path, time: Array, shapes: Array, rotation: Array, gaze: Array) -> None:
    """Write a take that Live Link Face tools read.

    ``time`` (F,) seconds, kept to 17 microseconds; ``shapes`` (F, 52) weights in arkit52 order;
    ``rotation`` (F, 3, 3) of the head from its straight look; ``gaze`` (F, 2, 2) as in
    Performance. Ten decimals. Raises OutputError.
    """
    column = {pascal(name): shapes[:, i] for i, name in enumerate(names())}
    column |= dict(zip(ANGLES[:3], (to_euler(rotation) * (-1.0, -1.0, 1.0)).T, strict=True))
    for i, side in enumerate(("Left", "Right")):
        column[f"{side}EyeYaw"] = -gaze[:, i, 0]
        column[f"{side}EyePitch"] = -gaze[:, i, 1]
        column[f"{side}EyeRoll"] = np.zeros(len(time))
    # Adding zero turns -0.0 into 0.0.
    values = np.round(np.stack([column[name] for name in csv_columns()], axis=1), 10) + 0.0
    with whole_file(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as text:
        count = values.shape[1]
        text.write(",".join(("Timecode", "BlendshapeCount", *csv_columns())) + "\n")
        for moment, row in zip(np.rint(time * TICKS).astype(np.int64), values, strict=True):
            text.write(f"{_timecode(int(moment))},{count},")
            text.write(",".join(f"{value:.10f}" for value in row) + "\n")


def swapped_names(swap: bool) -> tuple[str, ...]:
    """(52) the column to take for each shape of arkit52 order."""
    other = {a: b for pair in SIDEWAYS for a, b in (pair, pair[::-1])} if swap else {}
    return tuple(other.get(name, name) for name in names())


def _read_rows(
    path: Path, rows: Iterator[list[str]]
) -> tuple[Array, Array, NDArray[np.bool_], dict[str, int]]:
    """Ticks (F,), values (F, N), lost (F,), and the place of each named value."""
    columns = _columns(path, next(rows, []))
    width = len(columns)
    ticks: list[int] = []
    values = array("d")
    lost: list[bool] = []
    for line, row in enumerate(rows, start=2):
        if not row:
            continue
        if len(ticks) == MAX_FRAMES:
            raise FormatError(f"{path}: more than {MAX_FRAMES} rows; split the take")
        ticks.append(_ticks(path, line, row[0], ticks[-1] if ticks else None))
        lost.append(len(row) > 1 and row[1].strip() == "0")
        values.extend(
            (values[-width:] or [0.0] * width) if lost[-1] else _values(path, line, row, width)
        )
    if len(ticks) < 2:
        raise FormatError(f"{path}: {len(ticks)} frames; a performance needs at least two")
    table = np.frombuffer(values, dtype=float).reshape(len(ticks), width).copy()
    return np.array(ticks, dtype=float), table, np.array(lost), columns


def _columns(path: Path, header: list[str]) -> dict[str, int]:
    # Two spellings of the second column are about: BlendShapeCount and BlendshapeCount.
    head = [cell.strip().lower() for cell in header[:2]]
    if head != ["timecode", "blendshapecount"]:
        raise FormatError(
            f"{path}: not a Live Link Face CSV; its first line should begin with "
            "Timecode,BlendShapeCount"
        )
    cells = [cell.strip() for cell in header[2:]]
    columns = {name: i for i, name in enumerate(cells)}
    missing = [pascal(name) for name in names() if pascal(name) not in columns]
    if missing:
        more = f" and {len(missing) - 1} more" * (len(missing) > 1)
        raise FormatError(f"{path}: no column {missing[0]}{more}; export the take again")
    if len(columns) != len(cells) or len(cells) > MAX_COLUMNS:
        raise FormatError(f"{path}: columns of the same name, or more than {MAX_COLUMNS}")
    return columns


def _ticks(path: Path, line: int, text: str, before: int | None) -> int:
    """Thousandths of a frame since midnight of the first day, growing over midnight."""
    match = _TIMECODE.fullmatch(text.strip())
    hours, minutes, seconds, frames, parts = (
        (int(group or 0) for group in match.groups()) if match else (0, 0, 0, 99, 0)
    )
    if hours > 23 or minutes > 59 or seconds > 59 or frames >= FRAMES_PER_SECOND:
        raise FormatError(
            f"{path}: line {line}: time code '{text[:24]}', expected HH:MM:SS:FF.mmm with "
            f"FF below {FRAMES_PER_SECOND}"
        )
    moment = ((hours * 60 + minutes) * 60 + seconds) * TICKS + frames * 1000 + parts
    if before is not None:
        moment += before // _DAY * _DAY
        if moment < before - _DAY // 2:
            moment += _DAY
        if moment <= before:
            raise FormatError(f"{path}: line {line}: time goes back at '{text[:24]}'")
    return moment


def _values(path: Path, line: int, row: list[str], width: int) -> list[float]:
    try:
        found = [float(cell) if cell.strip() else 0.0 for cell in row[2:]]
    except ValueError as error:
        raise FormatError(f"{path}: line {line}: {error}") from error
    if len(found) != width:
        raise FormatError(f"{path}: line {line}: {len(found)} values, expected {width}")
    if not all(abs(value) <= LARGEST for value in found):
        raise FormatError(
            f"{path}: line {line}: a value beyond {LARGEST:g}; weights run from 0 to 1 and "
            "angles are radians"
        )
    return found


def _gaze(angles: Array, shapes: Array) -> Array:
    """(F, 2, 2) yaw to the subject's left and pitch up, of the left and the right eye."""
    if angles[:, 3:].any():
        return np.asarray(-angles[:, 3:].reshape(-1, 2, 3)[:, :, :2])
    weight = {name: shapes[:, i] for i, name in enumerate(names())}
    eyes = []
    for side, leftwards in (("Left", 1.0), ("Right", -1.0)):
        out = weight[f"eyeLookOut{side}"] - weight[f"eyeLookIn{side}"]
        up = weight[f"eyeLookUp{side}"] - weight[f"eyeLookDown{side}"]
        eyes.append(np.stack([_LOOK * leftwards * out, _LOOK * up], axis=-1))
    return np.stack(eyes, axis=1)


def _timecode(moment: int) -> str:
    frames, parts = divmod(moment, 1000)
    seconds, frames = divmod(frames, FRAMES_PER_SECOND)
    minutes, seconds = divmod(seconds, 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours % 24:02d}:{minutes:02d}:{seconds:02d}:{frames:02d}.{parts:03d}"
