"""Lids are mixed last: the character's lid follows the performer's, whatever else moves it.

Lids of several key models do not add up: a surprised face that blinks would stay open, a smiling
one shut too far, a sad one shut askew. So what moves an eye's lids besides its blink goes as the
blink comes, and shut eyes are shut by their blinks alone. Lids that were opened wide come back to
rest first: the straight way from wide open to shut leads through the eyeball.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numba import njit
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
    _blinks: NDArray[np.bool_] = field(init=False, repr=False)
    """(W,) pieces that are a blink."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "_blinks", self.blink.any(axis=0))

    def mix(self, weights: Array, closure: Array) -> Array:
        """Weights (F, W) with the blinks set so that each eye is open by 1 - closure (F, 2) of
        its neutral opening (a negative closure is a stare): never shut further than shut, never
        opened by a negative blink."""
        mixed = np.where(self._blinks, 0.0, weights)
        _mix(mixed, closure, self.opening, self.effect, self.blink, self.widens, self.narrows)
        return mixed


@njit(cache=True, nogil=True)
def _mix(
    weights: Array,
    closure: Array,
    opening: Array,
    effect: Array,
    blink: NDArray[np.bool_],
    widens: NDArray[np.bool_],
    narrows: NDArray[np.bool_],
) -> None:
    """Mix the lids into ``weights`` (F, W), whose blinks are at 0; fields as of ``Lids``."""
    pieces = range(weights.shape[1])
    wanted, back, shut, level = np.empty((4, 2))
    for f in range(len(weights)):
        for eye in range(2):
            wanted[eye] = (1.0 - min(closure[f, eye], 1.0)) * opening[eye]
            opened, widened = opening[eye], 0.0
            for w in pieces:
                opened += weights[f, w] * effect[eye, w]
                widened += weights[f, w] * effect[eye, w] * widens[eye, w]
            excess = max(opened - wanted[eye], 0.0)
            back[eye] = min(excess / max(widened, _LITTLE), 1.0)
            shut[eye] = min(excess / max(opened, _LITTLE), 1.0)
        for w in pieces:
            kept = 1.0
            for eye in range(2):
                kept -= back[eye] * widens[eye, w] + shut[eye] * narrows[eye, w]
            weights[f, w] *= kept
        for eye in range(2):
            missing, shuts = opening[eye] - wanted[eye], 0.0
            for w in pieces:
                missing += weights[f, w] * effect[eye, w]
                shuts -= effect[eye, w] * blink[eye, w]
            level[eye] = min(max(missing / shuts, 0.0), _MOST)
        for w in pieces:
            weights[f, w] += level[0] * blink[0, w] + level[1] * blink[1, w]


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
