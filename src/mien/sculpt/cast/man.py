"""The man: square, fair, blue-eyed, sparing with his face."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mien.sculpt.brush import bump
from mien.sculpt.bust import bust
from mien.sculpt.cast.human import ball_eyes, pair
from mien.sculpt.colour import paint_skin
from mien.sculpt.ears import EarShape, ear
from mien.sculpt.expressions import EXAMPLES, KEYS
from mien.sculpt.eyes import Iris
from mien.sculpt.hair import Scalp, cap, curve, shaded
from mien.sculpt.head import Head
from mien.sculpt.proportions import Brush, EyeShape, HairLine, HeadShape, MouthShape, Proportions
from mien.sculpt.sculpture import Sculpture
from mien.sculpt.skin import labels
from mien.sculpt.solid import Solid

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
        bend=2.2,
    ),
    HairLine(brow_up=-1.5, brow_width=4.6, brow_height=2.2, lash=1.2),
)


def _paint(head: Head) -> Array:
    colours = paint_skin(
        head, _SKIN, (0.84, 0.33, 0.25), (0.72, 0.38, 0.33), blush_amount=1.15, lip_amount=0.85
    )
    beard = bump(head.skin, (0, -72, 45), (46, 30, 60)) * np.clip(1 - 1.5 * labels().lips, 0, 1)
    return np.asarray(colours * (1 - 0.16 * beard[:, None] * [1, 0.85, 0.75]))


def _hair(neutral: Head) -> Solid:
    edge = curve(
        (0, 93), (25, 93), (45, 89), (59, 90), (70, 97), (79, 107), (88, 106), (97, 97), (108, 95),
        (125, 103), (180, 109),
    )  # fmt: skip

    def depth(azimuth: Array, along: Array) -> Array:
        tuft = np.exp(-(((azimuth - 10) / 44) ** 2)) * np.exp(-(((along - 0.78) / 0.25) ** 2))
        parting = 1 - 0.55 * np.exp(-(((azimuth + 40) / 8) ** 2))
        shorn = 1 - 0.50 * along * np.exp(-(((np.abs(azimuth) - 92) / 34) ** 2))
        return np.asarray((9 + 17 * tuft * parting) * shorn)

    form, ridge = cap(
        Scalp(neutral.skin), edge, depth, ridge=1.15, ridges=21, swirl=0.75, zigzag=1.3, teeth=13,
        around=126, rows=24,
    )  # fmt: skip
    return Solid("hair", "hair", *form, shaded(form, _DARK, _LIGHT, ridge))


def _dress(neutral: Head) -> Sequence[Solid]:
    return (
        *pair(ear(EarShape(height=28, width=16.5, root=(73, 11, -31)), _SKIN, (0.80, 0.42, 0.34))),
        _hair(neutral),
        bust((0.20, 0.33, 0.42), (0.93, 0.92, 0.88)),
    )


MAN = Sculpture(
    name="man",
    proportions=_PROPORTIONS,
    paint=_paint,
    eyes=ball_eyes(Iris((0.16, 0.30, 0.34), (0.42, 0.62, 0.60), 0.54, 0.25)),
    dress=_dress,
    keys=KEYS,
    examples=EXAMPLES,
    brow=(0.17, 0.10, 0.06),
)
