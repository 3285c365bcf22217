"""Facial animation parameter units (MPEG-4 FAPU): the lengths faces are compared by.

symbol     name      measured at the neutral
IRISD0     iris      lid opening, 3.1 - 3.3 and 3.2 - 3.4, y
ES0        eyes      distance of the pupils, 3.5 - 3.6, x
ENS0       nose      eye to nose base, 3.5 and 3.6 - 9.15, y
MNS0       philtrum  nose base to inner upper lip, 9.15 - 2.2, y
MW0        mouth     mouth width, 8.3 - 8.4, x
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Fapu:
    """Lengths in mm, not divided by 1024. NaN where a point they need is missing."""

    iris: float
    eyes: float
    nose: float
    philtrum: float
    mouth: float


def measure(points: Sequence[str], neutral: Array) -> Fapu:
    """The units of a neutral face from its feature points: ``points`` (P) FDP ids at ``neutral``
    (P, 3) mm, head frame."""
    row = {fdp: i for i, fdp in enumerate(points)}

    def span(first: str, second: str, axis: int) -> float:
        if first not in row or second not in row:
            return math.nan
        length = float(neutral[row[first], axis] - neutral[row[second], axis])
        return length if length > 0 else math.nan

    return Fapu(
        iris=_mean(span("3.1", "3.3", 1), span("3.2", "3.4", 1)),
        eyes=span("3.5", "3.6", 0),
        nose=_mean(span("3.5", "9.15", 1), span("3.6", "9.15", 1)),
        philtrum=span("9.15", "2.2", 1),
        mouth=span("8.3", "8.4", 0),
    )


def _mean(left: float, right: float) -> float:
    known = [length for length in (left, right) if not math.isnan(length)]
    return sum(known) / len(known) if known else math.nan
