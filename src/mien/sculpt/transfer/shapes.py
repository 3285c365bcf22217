"""The sets of key models that are made, and how a character that has them is driven."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from mien.face.character import Character
from mien.face.library import generic_face, load_character
from mien.sculpt.acting.visemes import VISEMES
from mien.vocabulary import arkit

_SPEAKER = "woman"
"""Whose visemes are transferred: the generic face has none."""
_EXPRESSIONS = ("smile", "sad", "anger", "fear", "disgust", "surprise")
_BLINKS = ("blink_left", "blink_right")
NOT_BY_POINTS = ("eyeLook", "mouthClose", "tongueOut")
"""Key models that no feature point tells: driven by gaze, by jawOpen's neighbour, or not at all."""


@dataclass(frozen=True, slots=True)
class ShapeSet:
    """Which key models, from whom."""

    source: str
    names: tuple[str, ...]


def shape_sets() -> Mapping[str, ShapeSet]:
    """By the name a user chooses them by: ARKit's 52, MPEG-4's six expressions and fourteen
    visemes, mien's own."""
    return {
        "arkit": ShapeSet("generic", arkit.names()),
        "mpeg4": ShapeSet(_SPEAKER, (*_EXPRESSIONS, *_BLINKS, "jaw_open", *VISEMES)),
        "mien": ShapeSet("generic", generic_face().examples),
    }


def driven(character: Character, chosen: str) -> Character:
    """``character``, made with the set ``chosen``, with what tells a mapper how to drive it."""
    if chosen != "arkit":
        return character
    names = character.keys.names
    acting = tuple(name for name in names if not name.startswith(NOT_BY_POINTS))
    return replace(
        character,
        examples=acting,
        whole=True,
        blinks=frozenset({"eyeBlinkLeft", "eyeBlinkRight"}),
        meanings={name: name for name in acting},
        speaks={"arkit": {name: (name,) for name in names}},
    )


def source_of(chosen: ShapeSet) -> Character:
    """The character whose key models are transferred."""
    return load_character(chosen.source)
