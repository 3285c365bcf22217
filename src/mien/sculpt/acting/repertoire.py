"""What a character can do: the thirteen, what editors want besides, and the visemes."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mien.sculpt.acting.expression import Expression
from mien.sculpt.acting.expressions import KEYS, tempered
from mien.sculpt.acting.units import EXTRAS
from mien.sculpt.acting.visemes import VISEMES

TAKES: Mapping[str, tuple[str, ...]] = {
    "mouth": (
        *("smile", "sad", "anger", "surprise", "disgust", "fear", "laugh", "frown", "sneer"),
        *("pucker", "wide", "pressed", "lips_in", "funnel", "viseme", "mouth", "tongue"),
        *("upper_lip", "lower_lip", "nose", "cheek"),
    ),
    "brow": ("sad", "anger", "surprise", "disgust", "fear", "sneer", "nose", "brow"),
    "jaw": (
        *("jaw", "surprise", "disgust", "fear", "laugh", "wide", "viseme", "funnel", "tongue"),
        *("pucker", "pressed", "lips_in"),
        *("mouthClose", "mouthFunnel", "mouthPucker", "mouthPress", "mouthRoll"),
    ),
    "lids": (
        *("surprise", "fear", "anger", "disgust", "laugh", "squint", "sneer", "nose", "eye"),
        "cheekSquint",
    ),
}
"""What key models take for themselves, by the beginnings of their names. Two that take the same do
not go together in full: a face has one mouth. Lips that are drawn tight or put forward are shaped
with the jaw. Blinks go with everything but other shapes of the same eye."""


def go_together(first: str, second: str) -> bool:
    """Whether people do both at once and in full; others they blend, half of each."""
    return not any(first.startswith(names) and second.startswith(names) for names in TAKES.values())


def repertoire(**changes: Mapping[str, Any]) -> dict[str, Expression]:
    """All key models of a character, some of them done in its own way: by name of the key model,
    fields of Expression that differ."""
    return tempered({**KEYS, **EXTRAS, **VISEMES}, changes)
