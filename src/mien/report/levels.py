"""What each key model of a character did."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.face.pieces import split
from mien.performance.curves import Curves

Array = NDArray[np.float64]


def levels(character: Character, curves: Curves) -> dict[str, Array]:
    """(F,) weight of each key model that is driven, the most active first: of its pieces the
    strongest. Other targets (animation parameters, wires) keep names of their own."""
    pieces = split(character)
    keys = [character.keys.names[key] for key in pieces.key]
    owner = dict(zip(pieces.names, keys, strict=True))
    found: dict[str, Array] = {}
    for target, weights in zip(curves.names, curves.weights.T, strict=True):
        name = owner.get(target, target)
        held = found.get(name, weights)
        found[name] = np.where(np.abs(weights) > np.abs(held), weights, held)
    return dict(sorted(found.items(), key=lambda item: -float((item[1] ** 2).sum())))
