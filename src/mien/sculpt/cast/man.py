"""The man: square, fair, blue-eyed, sparing with his face."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mien.sculpt.acting.expressions import EXAMPLES
from mien.sculpt.acting.repertoire import repertoire
from mien.sculpt.anatomy.bust import bust
from mien.sculpt.anatomy.ears import EarShape, ear
from mien.sculpt.anatomy.eyes import Iris
from mien.sculpt.anatomy.hair import Scalp, cap, curve, lock, shaded
from mien.sculpt.anatomy.head import Head
from mien.sculpt.anatomy.skin import labels
from mien.sculpt.brush import bump
from mien.sculpt.cast.human import TOLD_APART, ball_eyes, pair
from mien.sculpt.colour import paint_skin
from mien.sculpt.proportions import Brush, EyeShape, HairLine, HeadShape, MouthShape, Proportions
from mien.sculpt.sculpture import Sculpture
from mien.sculpt.solid import Form, Solid, merged

Array = NDArray[np.float64]

_SKIN = (0.87, 0.63, 0.50)
_DARK, _LIGHT = (0.13, 0.075, 0.045), (0.36, 0.215, 0.12)

_PROPORTIONS = Proportions(
    HeadShape(
        cranium=(1.03, 1.02, 1.0),
        face_width=1.06,
        jaw_width=1.08,
        midface=0.86,
        lower_face=0.99,
        chin_up=-6,
        chin_forward=5,
        nose=(0.98, 0.90, 0.90),
        nose_up=3,
        nostril=1.6,
        neck=0.80,
        brushes=(Brush((33, 6, 40), (22, 8, 24), (0, 0, 2.5)),),
    ),
    EyeShape(
        aside=32.5,
        height=22,
        depth=25,
        radius=19.3,
        half_width=19.2,
        upper=9.0,
        lower=8.0,
        tilt=0.4,
        offset=1.9,
    ),
    MouthShape(
        half_width=26,
        height=-35.5,
        depth=58,
        corner_depth=45,
        upper=4.3,
        lower=5.8,
        fullness=2.2,
        bend=2.9,
    ),
    HairLine(brow_up=-0.5, brow_width=3.9, brow_height=2.0, brow_inner=2.6, lash=1.2),
)


def _paint(head: Head) -> Array:
    colours = paint_skin(
        head, _SKIN, (0.84, 0.33, 0.25), (0.72, 0.38, 0.33), blush_amount=1.15, lip_amount=0.85
    )
    beard = bump(head.skin, (0, -72, 45), (46, 30, 60)) * np.clip(1 - 1.5 * labels().lips, 0, 1)
    return np.asarray(colours * (1 - 0.16 * beard[:, None] * [1, 0.85, 0.75]))


_PARTING = 30.0
"""Degrees of yaw, on his left."""


def _top(scalp: Scalp) -> list[Form]:
    """Swept from the parting over to his right, the front ones highest; each lies 1.5 mm above the
    one behind it."""
    forms = []
    for number in range(7):
        q, up = number / 6, 1.5 * (6 - number)
        pitch = 46 + 40 * q
        course = [
            (_PARTING + 4 + 6 * q, pitch + 4 - 4 * q, 1.0),
            (_PARTING - 14 + 4 * q, pitch + 9, 12 + up),
            (2 - 6 * q, pitch + 7 - 4 * q, 15 + up),
            (-28 - 12 * q, pitch - 2 - 14 * q, 12 + 0.8 * up),
            (-52 - 20 * q, pitch - 16 - 30 * q, 7 + 0.4 * up),
            (-66 - 24 * q, pitch - 28 - 34 * q, 3.0),
        ]
        forms.append(lock(scalp, course, 13.5, 6.5, rows=16, widest=0.4, start=0.3, end=0.1))
    for number in range(4):
        q, up = number / 3, 1.2 * (3 - number)
        course = [
            (_PARTING + 2 + 10 * q, 54 + 26 * q, 3.0),
            (_PARTING + 16 + 14 * q, 47 + 16 * q, 8 + up),
            (_PARTING + 32 + 22 * q, 34 + 4 * q, 7 + up),
            (_PARTING + 42 + 30 * q, 20 - 4 * q, 3.0),
        ]
        forms.append(lock(scalp, course, 12.0, 5.0, rows=11, widest=0.4, start=0.3, end=0.1))
    return forms


def _hair(neutral: Head) -> Solid:
    scalp = Scalp(neutral.skin)
    edge = curve(
        (0, 76), (20, 76), (38, 72), (50, 80), (62, 92), (72, 108), (80, 112), (88, 106), (98, 97),
        (108, 97), (125, 105), (180, 112),
    )  # fmt: skip

    def depth(azimuth: Array, along: Array) -> Array:
        shorn = 1 - 0.45 * along * np.exp(-(((np.abs(azimuth) - 92) / 34) ** 2))
        return np.asarray((5.5 + 3.5 * (1 - along)) * shorn)

    short, ridge = cap(
        scalp, edge, depth, ridge=0.35, ridges=44, swirl=0.5, zigzag=1.0, teeth=23, around=92,
        rows=18,
    )  # fmt: skip
    locks = _top(scalp)
    colours = [shaded(short, _DARK, _LIGHT, ridge), *(shaded(f, _DARK, _LIGHT) for f in locks)]
    return Solid("hair", "hair", *merged([short, *locks]), np.concatenate(colours))


def _dress(neutral: Head) -> Sequence[Solid]:
    return (
        *pair(ear(EarShape(height=28, width=16.5, root=(74, 13, -24)), _SKIN, (0.80, 0.42, 0.34))),
        _hair(neutral),
        bust((0.20, 0.33, 0.42), (0.93, 0.92, 0.88)),
    )


_KEYS = repertoire(
    **TOLD_APART,
    smile={"corner": (8.5, 8.0, -4.5), "cheek": (2.0, 4.0, 4.0)},
    anger={"brow_inner": (-5.0, -9.5, 3.0), "lid_tilt": -3.0},
)

MAN = Sculpture(
    name="man",
    proportions=_PROPORTIONS,
    paint=_paint,
    eyes=ball_eyes(Iris((0.16, 0.30, 0.34), (0.42, 0.62, 0.60), 0.54, 0.25)),
    dress=_dress,
    keys=_KEYS,
    examples=EXAMPLES,
    brow=(0.17, 0.10, 0.06),
)
