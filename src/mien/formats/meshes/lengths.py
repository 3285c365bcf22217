"""Units of length in files that name them, and what to say of files that do not."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError

Array = NDArray[np.float64]

UNITS = {"mm": 1.0, "cm": 10.0, "dm": 100.0, "m": 1000.0, "in": 25.4, "ft": 304.8}
"""Millimetres in each."""
_ALSO = {
    "millimeter": "mm", "millimetre": "mm", "centimeter": "cm", "centimetre": "cm",
    "decimeter": "dm", "decimetre": "dm", "meter": "m", "metre": "m", "inch": "in",
    "inche": "in", "foot": "ft", "feet": "ft",
}  # fmt: skip
_HEAD = 80.0
"""mm, distance of a face's points from their middle, root mean square; with a jig and some hair."""


def millimetres(path: Path, said: str, given: str | None, places: Array) -> float:
    """Millimetres in a unit: the one ``given`` by the user, else the one the file ``said``.

    ``places`` (..., 3) are numbers of the file (NaN: none), from which the likely unit is told
    where there is no other. Raises FormatError: a unit is never guessed.
    """
    name = (said if given is None else given).strip().strip("\0").lower()
    unit = name if name in UNITS else _ALSO.get(name.removesuffix("s"), "")
    if unit:
        return UNITS[unit]
    what = f"its unit '{name}' is not known" if name else "it names no unit"
    raise FormatError(f"{path}: {what}; say --units, here likely --units {likely(places)}")


def likely(places: Array) -> str:
    """The unit in which ``places`` (..., 3) of a face (NaN: none) have the size of one."""
    known = places.reshape(-1, 3)
    known = known[np.isfinite(known).all(axis=1)]
    if not len(known):
        return "mm"
    spread = float(np.sqrt(((known - np.median(known, axis=0)) ** 2).sum(axis=1).mean()))
    metric = ("mm", "cm", "m")
    return min(metric, key=lambda unit: abs(np.log(max(spread, 1e-12) * UNITS[unit] / _HEAD)))
