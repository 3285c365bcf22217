"""Lids are mixed last: the character's lid follows the performer's, whatever else moves it.

Lids of several key models do not add up: a surprised face that blinks would stay open, a smiling
one shut too far. So each eye's blink gets what is still missing after all other weights.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.face.face import Face
from mien.face.pieces import BLINKS, Pieces

Array = NDArray[np.float64]

MARGINS = (("3.1", "3.3"), ("3.2", "3.4"))
"""Upper and lower lid margin of the left and right eye."""
SCALARS = ("lid_left", "lid_right")
"""What a performance calls the closures."""
_MOST = 2.0
"""A blink that hardly moves its lid is not stretched beyond this."""


@dataclass(frozen=True, slots=True)
class Lids:
    """How a character's eyes shut."""

    blink: NDArray[np.bool_]
    """(2, W) pieces that are the blink of the left and right eye."""
    opening: Array
    """(2,) mm at neutral."""
    effect: Array
    """(2, W) mm by which a whole piece opens each eye."""

    def mix(self, weights: Array, closure: Array) -> Array:
        """Weights (F, W) with the blinks set so that each eye is open by 1 - closure (F, 2) of
        its neutral opening (a negative closure is a stare): never shut further than shut, never
        opened by a negative blink."""
        mixed = np.where(self.blink.any(axis=0), 0.0, weights)
        wanted = (1.0 - np.minimum(closure, 1.0)) * self.opening
        missing = self.opening + mixed @ self.effect.T - wanted
        shuts = -(self.effect * self.blink).sum(axis=1)
        level = np.clip(missing / shuts, 0.0, _MOST)
        return np.asarray(mixed + level @ self.blink)


def find_lids(character: Character, pieces: Pieces) -> Lids | None:
    """The lids of a character; None where it has no lid points or no blink for either eye."""
    face = character.face
    if any(fdp not in face.points.ids for margins in MARGINS for fdp in margins):
        return None
    is_blink = np.array([character.keys.names[key] in BLINKS for key in pieces.key])
    blink = np.stack([is_blink & (pieces.side == side) for side in (0, 1)])
    moved, rest = face.points.at(pieces.displacements), face.points.at(face.vertices)
    effect = np.stack([_height(face, moved, upper, lower) for upper, lower in MARGINS])
    opening = np.array([_height(face, rest, upper, lower) for upper, lower in MARGINS])
    shuts = -(effect * blink).sum(axis=1)
    return Lids(blink, opening, effect) if (shuts > 0).all() and (opening > 0).all() else None


def _height(face: Face, places: Array, upper: str, lower: str) -> Array:
    """(...) distance upwards from lower to upper margin of feature points (..., P, 3)."""
    margins = places[..., face.points.index((upper, lower)), 1]
    return np.asarray(margins[..., 0] - margins[..., 1])
