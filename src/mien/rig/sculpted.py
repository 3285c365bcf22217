"""What an artist has already sculpted of the key models that are to be made."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.formats.gltf.grown import write_grown
from mien.rig.acts import Act, measure
from mien.rig.importer import Import
from mien.rig.spoken import named_as_arkit

Fields = dict[str, NDArray[np.float32]]


@dataclass(frozen=True, slots=True)
class Sculpted:
    """Displacement fields (V, 3) mm."""

    own: Fields
    """By the key model each is."""
    poses: Fields
    """The others that move the face, by their own names: mixtures of key models."""
    spelt: frozenset[str]
    """Those of ``own`` that bear their names in the file already."""


def sculpted(neutral: Character, names: Sequence[str]) -> Sculpted:
    """The shapes of ``neutral`` that are some of the key models ``names``: by the map file, by
    name, or as ARKit spells it; and those that act and are none of them."""
    found: dict[str, list[str]] = {name: [] for name in names}
    rest: list[Act] = []
    spelt: set[str] = set()
    for act in measure(neutral):
        name = neutral.meanings.get(act.name, act.name)
        if name in found:
            found[name].append(act.name)
            spelt |= {name} & {act.name}
        elif act.name in neutral.examples:
            rest.append(act)
    for name, keys in named_as_arkit(rest).items():
        if name in found:
            found[name].extend(keys)
            spelt.add(name)
    own = {
        name: np.sum([neutral.keys[key] for key in keys], axis=0)
        for name, keys in found.items()
        if keys
    }
    used = {key for keys in found.values() for key in keys}
    poses = {act.name: neutral.keys[act.name] for act in rest if act.name not in used}
    return Sculpted(own, poses, frozenset(spelt))


def write_into_its_file(path: Path, found: Import, made: Character, kept: Sculpted) -> None:
    """The file of a neutral with the key models that were ``made`` of it as morph targets; those
    it has under their names already are not written twice. Raises OutputError, InputError;
    ValueError where the neutral did not come from a file that can hold them."""
    origin = found.character.origin
    if origin is None:
        raise ValueError(f"{found.character.name} came from no such file")
    rows = [i for i, name in enumerate(made.keys.names) if name not in kept.spelt]
    moved = made.keys.displacements[rows] @ origin.turn.T / origin.scale
    fields = np.zeros((len(rows), len(found.model.vertices), 3), dtype=np.float32)
    fields[:, origin.order] = moved
    write_grown(path, found.model, [made.keys.names[row] for row in rows], fields)
