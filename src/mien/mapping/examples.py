"""Source examples: what a performer's feature points would do to show each key model.

Kind (c) is measured on the character itself, which needs no names and is why any character can
be driven; kind (b) takes the generic face's key models of the same names. Both are brought to
the performer's size by FAPU.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.errors import InputError
from mien.face.character import Character
from mien.face.library import generic_face
from mien.face.pieces import Pieces, region_masks, shares, side_masks
from mien.mapping.size import scales

Array = NDArray[np.float64]

KINDS = ("character", "generic")

_NOT_SKIN = frozenset({"3.5", "3.6", "7.1"})
"""Pupils turn with the gaze and the neck with the head; no key model moves them."""
_FEWEST = 8
"""Points below which a face cannot be told from another."""


@dataclass(frozen=True, slots=True)
class Examples:
    """Motion of P feature points, mm at the performer's size."""

    points: tuple[str, ...]
    """(P) those of the performer's that the character has."""
    keys: Array
    """(K, P, 3) of each of the character's example key models."""
    pieces: Array
    """(W, P, 3)"""
    owner: NDArray[np.intp]
    """(W,) row of ``keys`` each piece belongs to."""
    masks: Array
    """(3, 2, P) share of each region and side in each point."""


def measure_examples(
    character: Character, pieces: Pieces, points: Sequence[str], neutral: Array, kind: str
) -> Examples:
    """Source examples for a performer with FDP ``points`` (P) at ``neutral`` (P, 3).

    ``kind`` is "character" (c) or "generic" (b). Raises InputError for another kind, for (b)
    where the generic face lacks a key model of that name, and where performer and character
    share too few points.
    """
    if kind not in KINDS:
        raise InputError(f"examples '{kind}' are not known; there are {', '.join(KINDS)}")
    model = character if kind == "character" else _named_alike(character)
    face = model.face
    row = {fdp: i for i, fdp in enumerate(points)}
    common = tuple(
        fdp
        for fdp in points
        if fdp in character.face.points.ids and fdp in face.points.ids and fdp not in _NOT_SKIN
    )
    if len(common) < _FEWEST:
        raise InputError(
            f"{character.name}: only {len(common)} of the performance's feature points are on this"
            f" face; at least {_FEWEST} are needed"
        )
    on_face = face.points.index(common)
    own = face.points.at(face.vertices)
    # Lengths such as the pupils' distance may need points that are not compared.
    both = tuple(fdp for fdp in points if fdp in face.points.ids)
    factors = scales(both, neutral[[row[fdp] for fdp in both]], own[face.points.index(both)])[
        [both.index(fdp) for fdp in common]
    ]
    names = [model.keys.names.index(name) for name in character.examples]
    keys = face.points.at(model.keys.displacements[names])[:, on_face] * factors
    keys = _as_meant(character, keys, common, points, neutral)
    regions, sides = region_masks(face, own[on_face]), side_masks(face, own[on_face])
    rows = [character.examples.index(character.keys.names[key]) for key in pieces.key]
    owner = np.array(rows, dtype=np.intp)
    if kind == "character":
        fields = face.points.at(pieces.displacements)[:, on_face] * factors
        fields = keys[owner] if character.meanings else fields
    else:
        fields = keys[owner] * shares(pieces.cells, regions, sides)[..., None]
    return Examples(common, keys, fields, owner, regions[:, None] * sides[None])


def _as_meant(
    character: Character,
    keys: Array,
    common: Sequence[str],
    points: Sequence[str],
    neutral: Array,
) -> Array:
    """``keys`` (K, P, 3) with those that stand for a key model of the generic face moving as that
    one does, at the performer's size."""
    if not character.meanings:
        return keys
    generic, meant = generic_face(), keys.copy()
    face = generic.face
    place = {fdp: i for i, fdp in enumerate(points)}
    shared = tuple(fdp for fdp in common if fdp in face.points.ids)
    rows = face.points.index(shared)
    rest = face.points.at(face.vertices)[rows]
    factors = scales(shared, neutral[[place[fdp] for fdp in shared]], rest)
    into = [common.index(fdp) for fdp in shared]
    for k, name in enumerate(character.examples):
        if name in character.meanings:
            field = face.points.at(generic.keys[character.meanings[name]])
            meant[k, into] = field[rows] * factors
    return meant


def _named_alike(character: Character) -> Character:
    generic = generic_face()
    for name in character.examples:
        if name not in generic.keys.names:
            raise InputError(
                f"{character.name}: the generic face has no key model '{name}';"
                " use examples of the character itself"
            )
    return generic
