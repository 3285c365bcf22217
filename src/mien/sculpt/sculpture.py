"""A sculpture: everything that makes one of the cast, and its parts in any pose."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from mien.sculpt.acting.expression import Expression
from mien.sculpt.anatomy import mouth
from mien.sculpt.anatomy.brows import brow, lashes
from mien.sculpt.anatomy.cage import cage
from mien.sculpt.anatomy.head import Head
from mien.sculpt.colour import Colour, linear
from mien.sculpt.proportions import EyeShape, Proportions
from mien.sculpt.solid import Solid

Array = NDArray[np.float64]


def _none(neutral: Head, posed: Head) -> Sequence[Solid]:
    return ()


@dataclass(frozen=True, slots=True)
class Sculpture:
    """One of the cast."""

    name: str
    proportions: Proportions
    paint: Callable[[Head], Array]
    """Colours (fine, 3) of the skin at rest."""
    eyes: Callable[[EyeShape, int], Sequence[Solid]]
    """What turns with the gaze, for the eye on that side."""
    dress: Callable[[Head], Sequence[Solid]]
    """What stays on the head, or on the body: ears, hair, garment."""
    keys: Mapping[str, Expression]
    examples: tuple[str, ...]
    brow: Colour
    lash: Colour = (0.10, 0.06, 0.05)
    teeth: bool = True
    skin: str = "skin"
    """Material of the skin."""
    ride: Callable[[Head, Head], Sequence[Solid]] = _none
    """What rides on the skin: of (neutral, posed)."""
    starts: Mapping[str, Expression] = field(default_factory=dict)


def skin_solid(sculpture: Sculpture, neutral: Head) -> Solid:
    """The skin, which comes first in every character."""
    triangles = cage().subdivision.triangles
    return Solid("skin", sculpture.skin, neutral.skin, triangles, sculpture.paint(neutral))


def still_parts(sculpture: Sculpture, neutral: Head) -> list[Solid]:
    """Parts no key model moves: eyes turn, the rest is carried by head or body."""
    eye = sculpture.proportions.eye
    solids = [solid for side in (1, -1) for solid in sculpture.eyes(eye, side)]
    if sculpture.teeth:
        solids.append(mouth.teeth(sculpture.proportions.mouth, upper=True))
    return [*solids, *sculpture.dress(neutral)]


def moving_parts(sculpture: Sculpture, neutral: Head, posed: Head) -> list[Solid]:
    """Parts that are rebuilt in every pose; always the same ones in the same order."""
    hair, lips = sculpture.proportions.hair_line, sculpture.proportions.mouth
    left = Solid("brow_left", "brow", *brow(posed), linear(sculpture.brow), shade=0.6)
    other = Solid("brow_left", "brow", *brow(posed.mirrored()), left.colours, shade=0.6)
    solids = [left, other.mirrored()]
    if hair.lash:
        for side, name in ((1, "lash_left"), (-1, "lash_right")):
            solids.append(Solid(name, "lash", *lashes(posed, side), linear(sculpture.lash)))
    if sculpture.teeth:
        lower = mouth.teeth(lips, upper=False)
        solids.append(replace(lower, vertices=mouth.with_jaw(lower, posed.expression)))
    tongue = mouth.tongue(lips)
    solids.append(replace(tongue, vertices=mouth.tongue_moved(tongue, posed.expression)))
    return [*solids, *sculpture.ride(neutral, posed)]
