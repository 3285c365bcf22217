"""Key models for a face that has none, by deformation transfer from one that has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.errors import InputError
from mien.face.character import Character, KeyModels
from mien.face.face import Array, Face
from mien.sculpt.transfer.artist import follow
from mien.sculpt.transfer.correspondence import correspond
from mien.sculpt.transfer.lids import close_lids
from mien.sculpt.transfer.lips import meet_lips
from mien.sculpt.transfer.parts import move_parts
from mien.sculpt.transfer.skin import Skin, skin_of
from mien.sculpt.transfer.solve import Transfer

Fields = Mapping[str, NDArray[np.floating[Any]]]


@dataclass(frozen=True, slots=True)
class Made:
    """A character that was made, and what its maker should know."""

    character: Character
    mixtures: Mapping[str, Mapping[str, float]]
    """Of each of the artist's poses that was understood, how much of each key model is in it."""
    notes: tuple[str, ...]
    """Plain sentences about what could not be made, or only doubtfully."""


def make(
    target: Face,
    source: Character,
    shapes: Sequence[str],
    name: str,
    sculpted: Fields | None = None,
    poses: Fields | None = None,
) -> Made:
    """Give ``target`` the key models ``shapes`` of ``source``.

    What its artist has ``sculpted`` under one of those names (V, 3) mm stays as it is; the others
    follow it, and the artist's ``poses``, which are mixtures of any of them. Both faces in the
    head frame with feature points on their skins. Raises InputError where they share too few
    points or where ``source`` lacks a shape.
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
    names, kept = tuple(shapes), dict(sculpted or {})
    followed = follow(made, names, own, _on(own, kept), _on(own, poses or {}))
    made, shut = close_lids(source.face, skin, motion, target, own, followed.made)
    made, met = meet_lips(
        source.face, skin, motion, target, own, made, names, pair.similarity.scale
    )
    moved = move_parts(target, own, made, source, names, pair.similarity).astype(np.float32)
    for shape, field in kept.items():
        moved[names.index(shape)] = field
    keys = KeyModels(names, moved)
    return Made(Character(name, target, keys, names), followed.mixtures, (*shut, *met))


def _on(skin: Skin, fields: Fields) -> dict[str, Array]:
    """Displacement fields (V, 3) as motion of the skin (N, 3)."""
    return {name: skin.gather(field) for name, field in fields.items()}
