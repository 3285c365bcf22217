"""The generic face: nobody in particular, the ground on which everything else stands."""

from __future__ import annotations

from collections.abc import Sequence

from mien.sculpt.acting.expressions import KEYS
from mien.sculpt.acting.units import ARKIT, STARTS, UNITS
from mien.sculpt.anatomy.bust import bust
from mien.sculpt.anatomy.ears import EarShape, ear
from mien.sculpt.anatomy.eyes import Iris
from mien.sculpt.anatomy.head import Head
from mien.sculpt.cast.human import ball_eyes, pair
from mien.sculpt.colour import paint_skin
from mien.sculpt.proportions import Brush, EyeShape, HairLine, HeadShape, MouthShape, Proportions
from mien.sculpt.sculpture import Sculpture
from mien.sculpt.solid import Solid

_SKIN, _BOWL = (0.80, 0.66, 0.58), (0.74, 0.50, 0.44)

_PROPORTIONS = Proportions(
    HeadShape(
        face_width=1.05,
        jaw_width=1.02,
        midface=0.93,
        lower_face=0.99,
        chin_up=-4,
        chin_forward=3,
        cheek=1.5,
        nose=(0.90, 0.88, 0.86),
        nose_up=2.5,
        nostril=1.2,
        neck=0.76,
        brushes=(Brush((33, 5, 40), (22, 8, 24), (0, 0, 2.5)),),
    ),
    EyeShape(aside=32, height=24, depth=25, radius=17.5, half_width=17.6),
    MouthShape(half_width=24.5, height=-37, depth=57.5, corner_depth=45),
    HairLine(),
)


def _dress(neutral: Head) -> Sequence[Solid]:
    return (
        *pair(ear(EarShape(height=27, width=15.5, root=(71.5, 13, -24)), _SKIN, _BOWL)),
        bust((0.55, 0.57, 0.60), (0.66, 0.68, 0.70)),
    )


GENERIC_FACE = Sculpture(
    name="generic",
    proportions=_PROPORTIONS,
    paint=lambda head: paint_skin(head, _SKIN, (0.78, 0.50, 0.44), (0.72, 0.45, 0.42)),
    eyes=ball_eyes(Iris((0.25, 0.22, 0.20), (0.50, 0.44, 0.38), 0.55, 0.25)),
    dress=_dress,
    keys={**KEYS, **UNITS, **ARKIT},
    examples=(*KEYS, *UNITS),
    brow=(0.36, 0.27, 0.22),
    starts=STARTS,
)
