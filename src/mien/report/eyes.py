"""How far each eye of a character is shut."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.face.targets import targets
from mien.performance.curves import Curves

Array = NDArray[np.float64]

SIDES = ("left", "right")
_LIDS = (("3.1", "3.3"), ("3.2", "3.4"))
"""Middle of the upper and of the lower lid, left and right."""
_LEAST = 0.5
"""mm between the lids of an eye that counts as open at neutral."""


def closures(character: Character, curves: Curves) -> dict[str, Array]:
    """(F,) for "left" and "right": 0 as open as at neutral, 1 lids that meet; below 0 wider.

    Measured between the lids' middles on the surface, whatever moves them. A side whose lids have
    no points or never open is left out.
    """
    points = character.face.points
    models = targets(character, curves.names)
    rest = points.at(character.face.vertices)
    found = {}
    for side, (upper, lower) in zip(SIDES, _LIDS, strict=True):
        if not {upper, lower} <= set(points.ids):
            continue
        over, under = points.index([upper, lower])
        gap = float(rest[over, 1] - rest[under, 1])
        moved = points.at(models.displacements.astype(float))
        change = curves.weights @ (moved[:, over, 1] - moved[:, under, 1])
        if gap > _LEAST:
            found[side] = -change / gap
    return found
