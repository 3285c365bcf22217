"""Key models for a face that has none, by deformation transfer from one that has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.errors import InputError
from mien.face.character import Character, KeyModels
from mien.face.face import Face
from mien.sculpt.transfer.correspondence import correspond
from mien.sculpt.transfer.lids import close_lids
from mien.sculpt.transfer.parts import move_parts
from mien.sculpt.transfer.skin import skin_of
from mien.sculpt.transfer.solve import Transfer


@dataclass(frozen=True, slots=True)
class Made:
    """A character that was made, and what its maker should know."""

    character: Character
    notes: tuple[str, ...]
    """Plain sentences about what could not be made, or only doubtfully."""


def make(
    target: Face,
    source: Character,
    shapes: Sequence[str],
    name: str,
    sculpted: Mapping[str, NDArray[np.floating[Any]]] | None = None,
) -> Made:
    """Give ``target`` the key models ``shapes`` of ``source``.

    What its artist has ``sculpted`` under one of those names (V, 3) mm stays as it is. Both faces
    in the head frame with feature points on their skins. Raises InputError where they share
    too few points or where ``source`` lacks a shape.
    """
    missing = [shape for shape in shapes if shape not in source.keys.names]
    if missing:
        raise InputError(f"{source.name}: has no key model '{missing[0]}'")
    try:
        own = skin_of(target)
    except ValueError as error:
        raise InputError(f"{name}: {error}") from error
    skin = skin_of(source.face)
    rows = [source.keys.names.index(shape) for shape in shapes]
    motion = skin.gather(source.keys.displacements[rows])
    pair = correspond(source.face, target, skin, own)
    made = Transfer(skin, own, pair, np.linalg.norm(motion, axis=2).max(axis=0))(motion)
    made, notes = close_lids(source.face, skin, motion, target, own, made)
    names = tuple(shapes)
    moved = move_parts(target, own, made, source, names, pair.similarity).astype(np.float32)
    for shape, field in (sculpted or {}).items():
        moved[names.index(shape)] = field
    keys = KeyModels(names, moved)
    return Made(Character(name, target, keys, names), notes)
