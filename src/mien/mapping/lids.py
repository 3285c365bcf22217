"""Lids are mixed last: the character's lid follows the performer's, whatever else moves it.

Lids of several key models do not add up: a surprised face that blinks would stay open, a smiling
one shut too far, a sad one shut askew. So what moves an eye's lids besides its blink goes as the
blink comes, and shut eyes are shut by their blinks alone. Lids that were opened wide come back to
rest first: the straight way from wide open to shut leads through the eyeball.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.face.face import Face
from mien.face.pieces import REGIONS, Pieces

Array = NDArray[np.float64]

MARGINS = (("3.1", "3.3"), ("3.2", "3.4"))
"""Upper and lower lid margin of the left and right eye."""
SCALARS = ("lid_left", "lid_right")
"""What a performance calls the closures."""
_MOST = 2.0
"""A blink that hardly moves its lid is not stretched beyond this."""
_LITTLE = 1e-9
_TOUCH = 0.05
"""Part of the opening by which a piece must move the lids to count among what moves them."""


@dataclass(frozen=True, slots=True)
class Lids:
    """How a character's eyes shut."""

    blink: NDArray[np.bool_]
    """(2, W) pieces that are the blink of the left and right eye."""
    opening: Array
    """(2,) mm at neutral."""
    effect: Array
    """(2, W) mm by which a whole piece opens each eye."""
    widens: NDArray[np.bool_]
    narrows: NDArray[np.bool_]
    """(2, W) pieces about an eye, its blink apart, that open or shut it."""
    _others: Array = field(init=False, repr=False)
    """(W,) 0 for blinks, 1 for all else."""
    _widening: Array = field(init=False, repr=False)
    """(W, 2) mm by which what widens each eye opens it."""
    _shuts: Array = field(init=False, repr=False)
    """(2,) mm by which each blink shuts its eye."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "_others", 1.0 - self.blink.any(axis=0))
        object.__setattr__(self, "_widening", (self.effect * self.widens).T)
        object.__setattr__(self, "_shuts", -(self.effect * self.blink).sum(axis=1))

    def mix(self, weights: Array, closure: Array) -> Array:
        """Weights (F, W) with the blinks set so that each eye is open by 1 - closure (F, 2) of
        its neutral opening (a negative closure is a stare): never shut further than shut, never
        opened by a negative blink."""
        weights = weights * self._others
        wanted = (1.0 - np.minimum(closure, 1.0)) * self.opening
        opened = self.opening + weights @ self.effect.T
        excess = np.maximum(opened - wanted, 0.0)
        widened = weights @ self._widening
        back = np.minimum(excess / np.maximum(widened, _LITTLE), 1.0)
        shut = np.minimum(excess / np.maximum(opened, _LITTLE), 1.0)
        weights = weights * (1.0 - back @ self.widens - shut @ self.narrows)
        missing = self.opening + weights @ self.effect.T - wanted
        level = np.minimum(np.maximum(missing / self._shuts, 0.0), _MOST)
        return np.asarray(weights + level @ self.blink)


def find_lids(character: Character, pieces: Pieces) -> Lids | None:
    """The lids of a character; None where it has no lid points or no blink for either eye."""
    face = character.face
    if any(fdp not in face.points.ids for margins in MARGINS for fdp in margins):
        return None
    is_blink = np.array([character.keys.names[key] in character.blinks for key in pieces.key])
    blink = np.stack([is_blink & (pieces.side == side) for side in (0, 1)])
    moved, rest = face.points.at(pieces.displacements), face.points.at(face.vertices)
    effect = np.stack([_height(face, moved, upper, lower) for upper, lower in MARGINS])
    opening = np.array([_height(face, rest, upper, lower) for upper, lower in MARGINS])
    shuts = -(effect * blink).sum(axis=1)
    if not ((shuts > 0).all() and (opening > 0).all()):
        return None
    if character.whole:
        # In anybody's file a blink at 1 is a shut eye; margins that cross would stop it short.
        effect = np.where(blink, -opening[:, None], effect)
    about = (pieces.region == REGIONS.index("eyes")) & ~is_blink
    own = about & (pieces.side == np.array([[0], [1]]))
    least = _TOUCH * opening[:, None]
    return Lids(blink, opening, effect, own & (effect > least), own & (effect < -least))


def _height(face: Face, places: Array, upper: str, lower: str) -> Array:
    """(...) distance upwards from lower to upper margin of feature points (..., P, 3)."""
    margins = places[..., face.points.index((upper, lower)), 1]
    return np.asarray(margins[..., 0] - margins[..., 1])
