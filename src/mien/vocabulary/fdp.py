"""The 84 feature points of MPEG-4 (FDP), by id such as "8.3". Sides are the subject's."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class FeaturePoint:
    """One point of the standard."""

    id: str
    """Group and index, "8.3"."""
    side: str
    """"left", "right" or "centre"."""
    mirror: str
    """The point on the other side; itself on the middle line."""
    place: str
    """Where it lies, in words."""
    faps: tuple[int, ...]
    """Numbers of the animation parameters that move it."""

    @property
    def group(self) -> int:
        """2 chin and inner lips, 3 eyes, 4 brows, 5 cheeks, 6 tongue, 7 neck, 8 outer lips, 9 nose
        and teeth, 10 ears, 11 hair."""
        return int(self.id.partition(".")[0])


@cache
def feature_points() -> Mapping[str, FeaturePoint]:
    """All points by id, in the standard's order."""
    text = resources.files("mien.vocabulary").joinpath("data/fdp.csv").read_text("utf-8")
    lines = (line for line in text.splitlines() if not line.startswith("#"))
    return MappingProxyType(
        {
            row["id"]: FeaturePoint(
                id=row["id"],
                side=row["side"],
                mirror=row["mirror"] or row["id"],
                place=row["place"],
                faps=tuple(int(number) for number in row["moved_by_faps"].split()),
            )
            for row in csv.DictReader(lines)
        }
    )
