"""How an imported character is driven, as the part of its file that says so."""

from __future__ import annotations

from typing import Any

import numpy as np

from mien.face.character import Character
from mien.face.face import Array
from mien.face.model import Bind, Hooks
from mien.face.origin import Origin

Json = dict[str, Any]

_MOST_BINDS = 1_000_000


def describe_driving(character: Character) -> Json:
    """JSON of what a character's file holds besides its face and key models."""
    return {
        "whole": character.whole,
        "blinks": sorted(character.blinks),
        "meanings": dict(character.meanings),
        "speaks": {
            name: {word: list(keys) for word, keys in words.items()}
            for name, words in character.speaks.items()
        },
        "looks": dict(character.looks),
        "origin": None if character.origin is None else _describe_origin(character.origin),
    }


def read_driving(told: Json, glb: bytes | None) -> Json:
    """The same as arguments of a Character. Raises ValueError, KeyError, TypeError,
    AttributeError where ``told`` is not of that form."""
    origin = told["origin"]
    return {
        "whole": bool(told["whole"]),
        "blinks": frozenset(map(str, told["blinks"])),
        "meanings": _words(told["meanings"]),
        "speaks": {
            str(name): {str(word): tuple(map(str, keys)) for word, keys in words.items()}
            for name, words in told["speaks"].items()
        },
        "looks": _words(told["looks"]),
        "origin": None if origin is None or glb is None else _read_origin(origin, glb),
    }


def _describe_origin(origin: Origin) -> Json:
    return {
        "binds": {
            name: [[bind.mesh, bind.target, bind.weight] for bind in binds]
            for name, binds in origin.binds.items()
        },
        "head": origin.hooks.head,
        "eyes": list(origin.hooks.eyes),
        "vrm": origin.hooks.vrm,
        "bones": dict(origin.hooks.bones),
        "turn": origin.turn.tolist(),
        "scale": origin.scale,
        "centre": origin.centre.tolist(),
        "expressions": dict(origin.expressions),
        "overrides": {name: dict(ways) for name, ways in origin.overrides.items()},
    }


def _read_origin(told: Json, glb: bytes) -> Origin:
    binds = {
        str(name): tuple(Bind(_row(m), _row(t), float(w)) for m, t, w in listed)
        for name, listed in told["binds"].items()
    }
    if sum(map(len, binds.values())) > _MOST_BINDS:
        raise ValueError("more binds than any character has")
    left, right = map(_node, told["eyes"])
    bones = {str(name): _row(node) for name, node in told["bones"].items()}
    hooks = Hooks(_node(told["head"]), (left, right), _node(told["vrm"]), bones)
    turn, centre = _numbers(told["turn"], (3, 3)), _numbers(told["centre"], (3,))
    scale = float(told["scale"])
    if not 0.0 < scale < 1e12:
        raise ValueError("a scale is out of bounds")
    overrides = {str(name): _words(ways) for name, ways in told.get("overrides", {}).items()}
    words = _words(told["expressions"])
    return Origin(glb, binds, hooks, turn, scale, centre, words, overrides)


def _numbers(value: Any, shape: tuple[int, ...]) -> Array:
    found = np.array(value, dtype=float)
    if found.shape != shape or not (np.abs(found) < 1e12).all():
        raise ValueError("a place or a turn is out of bounds")
    return found


def _words(value: Any) -> dict[str, str]:
    return {str(name): str(word) for name, word in value.items()}


def _row(value: Any) -> int:
    if type(value) is not int or value < 0:
        raise ValueError("a number of a node or a morph target is out of bounds")
    return value


def _node(value: Any) -> int | None:
    return None if value is None else _row(value)
