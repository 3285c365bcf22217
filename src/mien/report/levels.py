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
    strongest. Curves of other targets (animation parameters, wires) keep the names of those."""
    pieces = split(character)
    owners = list(curves.names)
    if curves.names == pieces.names:
        owners = [character.keys.names[key] for key in pieces.key]
    found: dict[str, Array] = {}
    for owner, weights in zip(owners, curves.weights.T, strict=True):
        held = found.get(owner)
        larger = weights if held is None else np.where(abs(weights) > abs(held), weights, held)
        found[owner] = np.asarray(larger)
    return dict(sorted(found.items(), key=lambda item: -float((item[1] ** 2).sum())))
