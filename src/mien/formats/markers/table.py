"""What text tables of markers share."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError, InputError
from mien.performance.marker_take import MarkerTake

Array = NDArray[np.float64]

_MOST_BYTES = 2**29
_MOST_CELLS = 120_000_000
_FARTHEST = 1e7


def read_lines(path: Path) -> list[str]:
    """The lines of a text file. Raises InputError, FormatError."""
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise FormatError(f"{path}: larger than 512 MB; cut the take into parts")
        return path.read_text("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise FormatError(f"{path}: not a text file") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error


def labels_of(names: Sequence[str]) -> tuple[str, ...]:
    """Names without the subject's prefix."""
    return tuple(name.strip().strip('"').rpartition(":")[2] for name in names)


def read_rows(path: Path, lines: Sequence[str], comma: str, columns: int, first: int) -> Array:
    """(F, columns) numbers of ``lines``, NaN for cells that are empty; blank lines do not count.
    ``first`` is the number of the first line. Raises FormatError."""
    if columns * len(lines) > _MOST_CELLS:
        raise FormatError(f"{path}: more numbers than memory should hold; cut the take into parts")
    rows = []
    for number, line in enumerate(lines, start=first):
        if not line.strip():
            continue
        cells = [cell.strip() for cell in line.split(comma)]
        cells = cells[:columns] + [""] * (columns - len(cells))
        try:
            rows.append([float(cell) if cell else np.nan for cell in cells])
        except ValueError as error:
            raise FormatError(f"{path}: line {number}: {error}") from error
    if not rows:
        raise FormatError(f"{path}: has no frames")
    return np.array(rows)


def take_of(
    path: Path,
    labels: tuple[str, ...],
    time: Array,
    rate: float | None,
    places: Array,
    unit: float,
) -> MarkerTake:
    """A take of ``places`` (F, M, 3) in a ``unit`` of millimetres, at ``time`` (F,) seconds, or at
    ``rate`` where the times say nothing. Raises FormatError."""
    places[~(np.abs(places) < _FARTHEST).all(axis=-1)] = np.nan
    if not labels or not np.isfinite(places).any():
        raise FormatError(f"{path}: no marker was seen in any frame")
    if not (np.isfinite(time).all() and (np.diff(time) > 0).all()):
        if not rate or not 0.1 <= rate <= 1e5:
            raise FormatError(f"{path}: its times do not rise, and it names no frame rate")
        time = np.arange(len(places)) / rate
    return MarkerTake(labels, time - time[0], places * unit, unit, path.name)
