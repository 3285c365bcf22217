"""Rectangles that a user drew round the features of a face: lines
``seconds,feature,left,top,right,bottom`` in pixels of the frame."""

from __future__ import annotations

import csv
import math
from collections.abc import Collection
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError, InputError

_MOST_LINES = 1000
_MOST_BYTES = 1 << 18


def read_rectangles(
    path: Path, features: Collection[str]
) -> dict[float, dict[str, NDArray[np.float64]]]:
    """By seconds and feature: (4,) left, top, right, bottom. Empty lines, lines that begin with #
    and a heading are passed over. Raises InputError where there is no file, FormatError."""
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    try:
        with path.open("rb") as stream:
            text = stream.read(_MOST_BYTES + 1).decode("utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise FormatError(f"{path}: not a text file") from error
    if len(text) > _MOST_BYTES:
        raise FormatError(f"{path}: too long for a few rectangles")
    found: dict[float, dict[str, NDArray[np.float64]]] = {}
    for number, row in enumerate(csv.reader(text.splitlines()), start=1):
        if not row or row[0].lstrip().startswith("#") or row[0].strip() == "seconds":
            continue
        where = f"{path}, line {number}"
        if number > _MOST_LINES or len(row) != 6:
            raise FormatError(f"{where}: expected seconds,feature,left,top,right,bottom")
        name = row[1].strip()
        if name not in features:
            raise FormatError(f"{where}: no feature '{name[:32]}'; there are {', '.join(features)}")
        try:
            time, *sides = (float(row[0]), *map(float, row[2:]))
        except ValueError as error:
            raise FormatError(f"{where}: expected seconds and four numbers") from error
        left, top, right, bottom = sides
        if not (all(map(math.isfinite, (time, *sides))) and left < right and top < bottom):
            raise FormatError(f"{where}: left must be below right, top above bottom")
        found.setdefault(time, {})[name] = np.array(sides)
    if not found:
        raise FormatError(f"{path}: no rectangle in it")
    return found
