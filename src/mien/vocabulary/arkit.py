"""The 52 face shapes of ARKit: what phones stream and most rigs speak. Sides are the subject's."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from types import MappingProxyType

SCALARS = {
    "lid_left": "eyeBlinkLeft",
    "lid_right": "eyeBlinkRight",
    "tongue_out": "tongueOut",
    "cheek_puff": "cheekPuff",
}
"""What a performance measures apart from its points, in ARKit's words."""


@dataclass(frozen=True, slots=True)
class FaceShape:
    """One shape; its weight runs from 0 to 1."""

    name: str
    """Apple's spelling, "eyeBlinkLeft"."""
    mirror: str
    """The same shape of the other side; itself where there is one for both."""
    csv: int
    """Place among the values of a Live Link Face CSV."""
    mediapipe: int | None
    """Place among MediaPipe's 52 blendshapes, None where it has no such shape."""
    what_it_does: str


@cache
def face_shapes() -> Mapping[str, FaceShape]:
    """All shapes by name, in the order of the Live Link Face stream: "arkit52 order"."""
    text = resources.files("mien.vocabulary").joinpath("data/arkit.csv").read_text("utf-8")
    lines = (line for line in text.splitlines() if not line.startswith("#"))
    return MappingProxyType(
        {
            row["name"]: FaceShape(
                name=row["name"],
                mirror=row["mirror"],
                csv=int(row["csv"]),
                mediapipe=int(row["mediapipe"]) if row["mediapipe"] else None,
                what_it_does=row["what_it_does"],
            )
            for row in csv.DictReader(lines)
        }
    )


def names() -> tuple[str, ...]:
    """(52) names in arkit52 order: the columns of ``Performance.shapes`` for "arkit"."""
    return tuple(face_shapes())


def pascal(name: str) -> str:
    """The spelling of Live Link and Unreal: "EyeBlinkLeft"."""
    return name[0].upper() + name[1:]
