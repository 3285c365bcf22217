"""What an artist has already sculpted of the key models that are to be made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.rig.acts import Act, measure
from mien.rig.spoken import named_as_arkit

Fields = dict[str, NDArray[np.float32]]


@dataclass(frozen=True, slots=True)
class Sculpted:
    """Displacement fields (V, 3) mm."""

    own: Fields
    """By the key model each is."""
    poses: Fields
    """The others that move the face, by their own names: mixtures of key models."""


def sculpted(neutral: Character, names: Sequence[str]) -> Sculpted:
    """The shapes of ``neutral`` that are some of the key models ``names``: by the map file, by
    name, or as ARKit spells it; and those that act and are none of them."""
    found: dict[str, list[str]] = {name: [] for name in names}
    rest: list[Act] = []
    for act in measure(neutral):
        name = neutral.meanings.get(act.name, act.name)
        if name in found:
            found[name].append(act.name)
        elif act.name in neutral.examples:
            rest.append(act)
    for name, keys in named_as_arkit(rest).items():
        found.get(name, []).extend(keys)
    own = {
        name: np.sum([neutral.keys[key] for key in keys], axis=0)
        for name, keys in found.items()
        if keys
    }
    used = {key for keys in found.values() for key in keys}
    poses = {act.name: neutral.keys[act.name] for act in rest if act.name not in used}
    return Sculpted(own, poses)
