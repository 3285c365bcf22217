"""MPEG-4 animation as text, ``.fap``: a line that says which FAPs follow, then their values.

    [2.1 NAME FPS FRAMES]            a header, which some writers leave out
    0 0 1 1 0 ... (68 or 69)         the mask: FAP k is given where token k is 1
    NUMBER VALUE VALUE ...           the frame's number, then the values in the order of the FAPs

FAP 1 is four values (two visemes, blend, definition) or, in Greta's files, one; FAP 2 is six (two
expressions with their intensities, init_face, definition) or one: the count of the line tells. A
69th token is padding. Frames count, not what the header promises; their numbers give the time.
Dialects: Xface (CRLF, a path for a name), Greta in Java (69 tokens, blanks in the name), SEMAINE
(no header), Visage (comments).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import TextIO

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError, InputError
from mien.formats.atomic import whole_file

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

FAPS = 68
MAX_FRAMES = 200_000
"""Two hours at 25 a second; frame numbers may reach ten times as far."""
MAX_LINE = 16_384
"""Characters; 80 values take a few hundred."""
LARGEST = 1e7
"""A head that turned by more than 316200 would look backwards; rubbish is larger."""
USUAL_RATE = 25.0
"""Frames a second where no header tells."""
VISEME, EXPRESSION = 4, 6
"""Values of FAPs 1 and 2 in full."""
_MOST_SELECTED = (14, 6)


@dataclass(frozen=True, slots=True)
class FapTake:
    """The content of a file, frames in the order of their numbers."""

    rate: float
    """Frames a second."""
    number: NDArray[np.int64]
    """(F,) frame numbers, increasing."""
    mask: Mask
    """(F, 68) which FAPs are given; column k - 1 is FAP k."""
    values: Array
    """(F, 68) zero where not given; FAPs 1 and 2 only where they came as one value."""
    viseme: Array
    """(F, 4) viseme_select1, viseme_select2, viseme_blend, viseme_def; zero where not given."""
    expression: Array
    """(F, 6) expression_select1, _intensity1, _select2, _intensity2, init_face, expression_def."""
    name: str = ""
    version: str = "2.1"


@dataclass(frozen=True, slots=True)
class Dialect:
    """How to write."""

    header: bool = True
    tokens: int = FAPS
    """68, or 69 as Greta does."""
    short: bool = False
    """FAPs 1 and 2 as one value each, as Greta does."""
    line_end: str = "\n"


@dataclass(slots=True)
class _Frames:
    number: list[int] = field(default_factory=list)
    mask: list[Mask] = field(default_factory=list)
    values: list[Array] = field(default_factory=list)
    viseme: list[Array] = field(default_factory=list)
    expression: list[Array] = field(default_factory=list)


def read_take(path: Path) -> FapTake:
    """Read a file of any dialect. Raises InputError where there is none, FormatError for another
    kind of file or a broken one, naming the line."""
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    try:
        with path.open(encoding="utf-8-sig", errors="replace", newline=None) as text:
            return _read(path, _lines(path, text))
    except OSError as error:
        raise FormatError(f"{path}: cannot be read ({error.strerror})") from error


def write_take(path: Path, take: FapTake, dialect: Dialect | None = None) -> None:
    """Write ``take`` so that reading it gives the same values to the bit. Raises OutputError;
    ValueError where it holds compounds that ``dialect`` has no words for."""
    dialect = dialect or Dialect()
    if dialect.short and (take.viseme.any() or take.expression.any()):
        raise ValueError("visemes and expressions in full cannot be written as one value")
    with whole_file(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as text:
        if dialect.header:
            name = " ".join(take.name.split()) or path.name
            head = f"{take.version} {name} {_number(take.rate)} {len(take.number)}"
            text.write(head + dialect.line_end)
        for frame in range(len(take.number)):
            for line in _frame(take, frame, dialect):
                text.write(" ".join(line) + dialect.line_end)


def simple_take(time: Array, values: Array) -> FapTake:
    """A take of FAPs 3 to 68 at ``values`` (F, 66), frames at ``time`` (F,) seconds.

    Files have a whole number of frames a second and whole values: the nearest rate is taken, and
    what lies between two frames is interpolated.
    """
    steps = np.diff(time)
    rate = float(np.clip(np.rint(1.0 / np.median(steps)), 1, 1000)) if len(steps) else USUAL_RATE
    number = np.arange(int(np.floor((time[-1] - time[0]) * rate + 1e-6)) + 1)
    at = time[0] + number / rate
    columns = [np.interp(at, time, column) for column in values.T]
    full = np.zeros((len(number), FAPS))
    full[:, 2:] = np.rint(np.clip(np.stack(columns, axis=1), -LARGEST, LARGEST))
    mask = np.ones((len(number), FAPS), dtype=bool)
    mask[:, :2] = False
    none = np.zeros((len(number), VISEME)), np.zeros((len(number), EXPRESSION))
    return FapTake(rate, number, mask, full, *none)


def _frame(take: FapTake, frame: int, dialect: Dialect) -> tuple[list[str], list[str]]:
    mask = take.mask[frame]
    values = list(take.values[frame])
    given: list[float] = []
    for column in np.flatnonzero(mask):
        full = (take.viseme, take.expression)[column][frame] if column < 2 else None
        given += [values[column]] if full is None or dialect.short else list(full)
    tokens = [str(int(on)) for on in mask] + ["0"] * (dialect.tokens - FAPS)
    return tokens, [str(int(take.number[frame])), *map(_number, given)]


def _number(value: float) -> str:
    """The shortest text that reads back as the same number; whole numbers as such."""
    return str(int(value)) if value == int(value) else repr(float(value))


def _lines(path: Path, text: TextIO) -> Iterator[tuple[int, list[str]]]:
    """Numbers of lines and their tokens; comments and empty lines left out."""
    number = 0
    while line := text.readline(MAX_LINE):
        number += 1
        if len(line) == MAX_LINE and not line.endswith("\n"):
            raise FormatError(f"{path}: line {number} is longer than any frame; not a .fap file")
        tokens = line.partition("#")[0].split()
        if tokens:
            yield number, tokens


def _read(path: Path, lines: Iterator[tuple[int, list[str]]]) -> FapTake:
    first = next(lines, None)
    if first is None:
        raise FormatError(f"{path}: it is empty")
    version, name, rate = "2.1", "", USUAL_RATE
    if _is_mask(first[1]):
        lines = chain([first], lines)
    else:
        version, name, rate = _header(path, *first)
    frames = _Frames()
    for number, tokens in lines:
        mask = _mask(path, number, tokens)
        below = next(lines, None)
        if below is None:
            raise FormatError(f"{path}: line {number}: a mask without values; the file is cut off")
        if len(frames.number) == MAX_FRAMES:
            raise FormatError(f"{path}: more than {MAX_FRAMES} frames; split the take")
        _take_frame(path, frames, mask, *below)
    return _ordered(path, frames, version, name, rate)


def _header(path: Path, line: int, tokens: list[str]) -> tuple[str, str, float]:
    """Version, name and rate; the number of frames is not to be trusted."""
    broken = FormatError(
        f"{path}: line {line}: neither a header (2.1 NAME FPS FRAMES) nor a mask of {FAPS} tokens "
        "0 or 1; not a .fap file"
    )
    if len(tokens) < 3 or "." not in tokens[0]:
        raise broken
    try:
        rate = float(tokens[-2])
        float(tokens[-1])
    except ValueError:
        raise broken from None
    if not 0.1 <= rate <= 1000.0:
        raise FormatError(
            f"{path}: line {line}: {tokens[-2]} frames a second; the header should be "
            "2.1 NAME FPS FRAMES"
        )
    return tokens[0], " ".join(tokens[1:-2]), rate


def _is_mask(tokens: list[str]) -> bool:
    return len(tokens) in (FAPS, FAPS + 1) and set(tokens) <= {"0", "1"}


def _mask(path: Path, line: int, tokens: list[str]) -> Mask:
    if not _is_mask(tokens):
        raise FormatError(
            f"{path}: line {line}: {len(tokens)} tokens, expected a mask of {FAPS} (or "
            f"{FAPS + 1}) tokens 0 or 1"
        )
    mask = np.array(tokens) == "1"
    if mask[FAPS:].any():
        raise FormatError(f"{path}: line {line}: token {FAPS + 1} is 1, but there is no such FAP")
    return np.asarray(mask[:FAPS])


def _take_frame(path: Path, frames: _Frames, mask: Mask, line: int, tokens: list[str]) -> None:
    try:
        number = int(tokens[0])
        given = np.array(tokens[1:], dtype=float)
    except ValueError as error:
        raise FormatError(f"{path}: line {line}: {error}") from error
    if not (np.abs(given) <= LARGEST).all():
        raise FormatError(f"{path}: line {line}: a value that is not finite, or beyond {LARGEST:g}")
    if not 0 <= number < 10 * MAX_FRAMES:
        raise FormatError(f"{path}: line {line}: frame number {tokens[0][:24]} is out of bounds")
    values, viseme, expression = np.zeros(FAPS), np.zeros(VISEME), np.zeros(EXPRESSION)
    simple = int(mask[2:].sum())
    widths = _widths(len(given) - simple, mask)
    if widths is None:
        raise FormatError(
            f"{path}: line {line}: {len(given)} values for a mask of {int(mask.sum())} FAPs"
        )
    at = 0
    for column, width in enumerate(widths):
        run = given[at : at + width]
        if width == 1:
            values[column] = run[0]
        elif width:
            (viseme, expression)[column][:] = run
            _selected(path, line, run[[0, 1]] if column == 0 else run[[0, 2]], column)
        at += width
    values[2:][mask[2:]] = given[at:]
    frames.number.append(number)
    frames.mask.append(mask)
    frames.values.append(values)
    frames.viseme.append(viseme)
    frames.expression.append(expression)


def _widths(count: int, mask: Mask) -> tuple[int, int] | None:
    """How many of ``count`` values FAPs 1 and 2 take; no two ways take as many."""
    ways = {
        (first, second)
        for first in ((1, VISEME) if mask[0] else (0,))
        for second in ((1, EXPRESSION) if mask[1] else (0,))
        if first + second == count
    }
    return ways.pop() if ways else None


def _selected(path: Path, line: int, chosen: Array, column: int) -> None:
    most = _MOST_SELECTED[column]
    if not (np.isin(chosen, np.arange(most + 1))).all():
        what = ("viseme", "expression")[column]
        raise FormatError(f"{path}: line {line}: {what}s are numbered from 0 to {most}")


def _ordered(path: Path, frames: _Frames, version: str, name: str, rate: float) -> FapTake:
    if not frames.number:
        raise FormatError(f"{path}: it holds no frames")
    number = np.array(frames.number, dtype=np.int64)
    order = np.argsort(number, kind="stable")
    twice = np.flatnonzero(np.diff(number[order]) == 0)
    if len(twice):
        raise FormatError(f"{path}: frame {number[order][twice[0]]} is there twice")
    return FapTake(
        rate=rate,
        number=number[order],
        mask=np.array(frames.mask)[order],
        values=np.array(frames.values)[order],
        viseme=np.array(frames.viseme)[order],
        expression=np.array(frames.expression)[order],
        name=name,
        version=version,
    )
