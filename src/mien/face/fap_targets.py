"""FAPs as morph targets: weights of fields that add up, and what keeps their sum a face.

A FAP says where a point goes along an axis and no more, which taken literally drags lids through
eyeballs and lips through teeth. So each lid and each corner of the mouth has a second field, its
slide, which carries it round what lies behind; and what touches stops.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from mien.errors import InputError
from mien.face.character import Character, KeyModels
from mien.face.face import Array
from mien.face.fap_basis import CORNERS, LIDS, FapBasis, fap_basis
from mien.vocabulary.fap import PER_UNIT, column, faps, names, simple

SLIDES = tuple(
    f"slide_{faps()[number].name.partition('_')[2]}" for number in (*LIDS, *(c[0] for c in CORNERS))
)
_TARGETS = (*names(), *SLIDES)
_MEET = ((4, 5), (8, 10), (9, 11))
"""FAPs of an upper lip, down, and the lower lip, up, that meet."""


@lru_cache(maxsize=8)
def basis_of(character: Character) -> FapBasis:
    """The basis of a character's face, kept: do not write into it. Raises InputError."""
    try:
        return fap_basis(character.face)
    except InputError as error:
        raise InputError(f"{character.name}: {error}") from error


def is_fap(name: str) -> bool:
    """Whether ``name`` is one of ``fap_models``'."""
    return name in _TARGETS


@lru_cache(maxsize=8)
def fap_models(character: Character) -> KeyModels:
    """The morph targets by which FAPs drive a character: each FAP that moves something, as far as
    faces can do it (``Fap.reach``), then the slides. Kept, as above."""
    basis = basis_of(character)
    reach = np.array([fap.reach for fap in simple()], dtype=np.float32)
    fields = np.concatenate([basis.fields * reach[:, None, None], basis.slides])
    moving = [i for i, field in enumerate(fields) if field.any()]
    return KeyModels(tuple(_TARGETS[i] for i in moving), fields[moving])


def fap_weights(character: Character, values: Array) -> Array:
    """Weights (F, W) of ``fap_models`` at FAP ``values`` (F, 66).

    A lid slides by 4 t (1 - t) at the part t of a whole opening, which is how far a chord lies
    inside its circle; a corner of the mouth as far as it is stretched.
    """
    met = met_values(values, basis_of(character).closed)
    weights = met / np.array([fap.reach for fap in simple()])
    part = met[:, [column(number) for number in LIDS]] / PER_UNIT
    aside = [weights[:, [column(number) for number in edges]].mean(axis=1) for edges in CORNERS]
    everything = np.column_stack([weights, 4.0 * part * (1.0 - part), *aside])
    return everything[:, [_TARGETS.index(name) for name in fap_models(character).names]]


def met_values(values: Array, closed: float) -> Array:
    """``values`` (F, 66) with what would pass through each other stopped where it meets: lips
    give way by halves (``closed`` is the value at which they touch), an upper lid rests on the
    lower."""
    met = np.array(values, dtype=float)
    for above, below in _MEET:
        pair = [column(above), column(below)]
        met[:, pair] -= np.maximum(met[:, pair].sum(axis=1, keepdims=True) - closed, 0.0) / 2.0
    for above, below in zip(LIDS[:2], LIDS[2:], strict=True):
        met[:, column(above)] = np.minimum(met[:, column(above)], PER_UNIT - met[:, column(below)])
    return met
