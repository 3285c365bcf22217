"""Vocabularies a character speaks: recognised by name, believed only where measurement agrees."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

from mien.rig.acts import Act
from mien.vocabulary.arkit import face_shapes

_ENOUGH = 20
"""Of ARKit's 52 names, for a character to speak ARKit."""
_HALVES = ("browInnerUp", "cheekPuff")
"""Shapes for both sides at once that some rigs (ICT-FaceKit) have in halves."""
_SIDES = {"left": "left", "right": "right", "l": "left", "r": "right"}
_CLEAR = 0.65
"""Part of a shape's motion on a side that contradicts a name that says the other."""


def plain(name: str) -> str:
    """ "Face.EyeBlink_L" as "eyeblinkleft": ARKit's spellings told from each other no more."""
    name = name.rpartition(".")[2]
    spaced = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", name)
    words = [word.lower() for word in re.split(r"[^A-Za-z0-9]+", spaced) if word]
    if words and words[-1] in _SIDES:
        words[-1] = _SIDES[words[-1]]
    return "".join(words)


def side_of(name: str) -> str:
    """ "left", "right", or empty where a name tells no side."""
    spaced = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", " ", name)
    words = [word.lower() for word in re.split(r"[^A-Za-z0-9]+", spaced) if word]
    found = {_SIDES[word] for word in words if word in _SIDES}
    return found.pop() if len(found) == 1 else ""


def disagreements(acts: Iterable[Act]) -> list[str]:
    """What to say of shapes whose names tell another side than they move."""
    told = []
    for act in acts:
        side = side_of(act.name)
        share = {"left": 1.0 - act.left, "right": act.left}.get(side, 0.0)
        if act.region and share > _CLEAR and not _goes_sideways(act.name):
            told.append(f"{act.name} moves the other side: driven by what it does")
    return told


def _goes_sideways(name: str) -> bool:
    """ "mouthLeft" and "jawLeft" name where something goes, and "lookLeft" where eyes look."""
    word = plain(name)
    return word in ("mouthleft", "mouthright", "jawleft", "jawright") or "look" in word


def arkit_keys(acts: Sequence[Act]) -> Mapping[str, tuple[str, ...]]:
    """ARKit's names and the key models that answer to them; empty where too few do."""
    found = named_as_arkit(acts)
    return found if len(found) >= _ENOUGH else {}


def named_as_arkit(acts: Sequence[Act]) -> dict[str, tuple[str, ...]]:
    """ARKit's names and the key models that bear them and move as they should."""
    known = {shape.name.lower(): shape for shape in face_shapes().values()}
    found: dict[str, list[str]] = {}
    for act in acts:
        word = plain(act.name)
        shape = known.get(word)
        for half in _HALVES:
            if word in (f"{half.lower()}left", f"{half.lower()}right"):
                shape = known[half.lower()]
        if shape is None:
            continue
        turned = shape.mirror != shape.name and bool(disagreements([act]))
        found.setdefault(shape.mirror if turned else shape.name, []).append(act.name)
    return {name: tuple(keys) for name, keys in found.items()}


def vocabulary_of(acts: Sequence[Act]) -> str:
    """What the names are, for a person to read: "arkit", "makehuman", "oculus", "vrm" or
    empty."""
    words = {plain(act.name) for act in acts}
    signs = {
        "makehuman": {"mouthcornerpuller", "mouthparling", "eyeleftclosure", "nosecompression"},
        "oculus": {"visemepp", "visemeff", "visemeaa", "visemedd"},
        "vrm": {"aa", "ih", "ou", "ee", "oh"},
    }
    if arkit_keys(acts):
        return "arkit"
    return next((name for name, some in signs.items() if len(some & words) >= 3), "")
