"""The woman: fine-boned, brown, with large eyes and a bob; quick to show what she feels."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mien.sculpt.acting.expressions import EXAMPLES
from mien.sculpt.acting.repertoire import repertoire
from mien.sculpt.anatomy.bust import bust
from mien.sculpt.anatomy.ears import EarShape, ear
from mien.sculpt.anatomy.eyes import Iris
from mien.sculpt.anatomy.hair import Scalp, cap, curve, lock, shaded
from mien.sculpt.anatomy.head import Head
from mien.sculpt.brush import ramp
from mien.sculpt.cast.human import TOLD_APART, ball_eyes, pair
from mien.sculpt.colour import mix, paint_skin
from mien.sculpt.proportions import (
    Brush,
    EyeShape,
    HairLine,
    HeadShape,
    MouthShape,
    Proportions,
    Temper,
)
from mien.sculpt.sculpture import Sculpture
from mien.sculpt.solid import Form, Solid, merged

_SKIN = (0.72, 0.47, 0.34)
_DARK, _LIGHT = (0.075, 0.035, 0.03), (0.30, 0.13, 0.085)
_SHADOW = (0.10, 0.045, 0.035)
_PARTING = -16.0

_PROPORTIONS = Proportions(
    HeadShape(
        cranium=(1.02, 1.04, 1.0),
        face_width=1.03,
        jaw_width=0.90,
        midface=0.82,
        lower_face=0.91,
        chin_up=-5,
        chin_forward=1,
        cheek=3.5,
        nose=(0.72, 0.72, 0.68),
        nose_up=4,
        nostril=0.6,
        neck=0.73,
        brushes=(Brush((34, 4, 40), (24, 9, 24), (0, 0, 4.5)),),
    ),
    EyeShape(
        aside=33.5,
        height=21,
        depth=24.5,
        radius=20.5,
        half_width=21,
        upper=10.2,
        lower=8.6,
        tilt=2.0,
        offset=2.1,
    ),
    MouthShape(
        half_width=22.5,
        height=-31,
        depth=57,
        corner_depth=45.5,
        upper=6.2,
        lower=7.4,
        fullness=3.0,
        bend=2.6,
    ),
    HairLine(
        brow_up=0.8, brow_width=2.6, brow_height=1.3, brow_inner=2.4, lash=5.2, lash_width=1.5
    ),
    Temper(brows=1.1, cheeks=0.7),
)


def _curtain(scalp: Scalp) -> list[Form]:
    """Sides and back, from the parting down to the jaw."""
    forms = []
    for side in (1, -1):
        for yaw in np.linspace(66, 176, 9):
            tip = 0.98 * yaw + (0 if yaw > 90 else 4)
            low = -51 if yaw < 150 else -54
            course = [
                (_PARTING + side * (yaw - _PARTING * side) * 0.45, 66, 11),
                (side * yaw * 0.92, 38, 16),
                (side * yaw, 8, 19),
                (side * (yaw + 2), -22, 21 + (4 if yaw < 110 else 0)),
                (side * (tip - 3), -44, 24),
                (side * (tip - 12), low, 12),
            ]
            forms.append(lock(scalp, course, 15.5, 8.5, widest=0.55, start=0.4, end=0.22, rows=15))
    return forms


def _fringe(scalp: Scalp) -> list[Form]:
    """Swept from the parting to either side, each lock 2 mm above its neighbour."""
    forms = []
    for side, roots in ((1, (4.0, 12.0)), (-1, (-4.0, -9.0))):
        # Under the first ones, where the scalp would show beside the parting.
        for root in roots:
            course: list[tuple[float, float, float]] = [
                (_PARTING + 0.3 * root, 70, 5),
                (_PARTING + root, 60, 12),
                (_PARTING + 2.6 * root + 4 * side, 50, 13),
                (_PARTING + 4.0 * root + 14 * side, 38, 12),
                (_PARTING + 4.6 * root + 34 * side, 20, 11),
            ]
            forms.append(lock(scalp, course, 13.0, 6.0, widest=0.5, start=0.5, end=0.1, rows=12))
    for number in range(5):
        q, up = number / 4, 1.8 * (4 - number)
        course = [
            (_PARTING + 5 - 1.5 * number, 72 - 5 * number, 4 + 0.5 * up),
            (_PARTING + 17 + 18 * q, 55 - 5 * q, 17 + up - 3 * q),
            (20 + 34 * q, 34 - 7 * q, 17 + up - 2 * q),
            (46 + 28 * q, 13 - 9 * q, 15.5 + up),
            (64 + 21 * q, -14 - 8 * q, 14 + 0.7 * up),
            (68 + 17 * q, -42 - 6 * q, 12 + 0.5 * up),
        ]
        forms.append(lock(scalp, course, 15.5, 7, widest=0.42, start=0.35, end=0.06, rows=18))
    for number in range(4):
        q, up = number / 3, 1.8 * (3 - number)
        course = [
            (_PARTING - 5 - number, 72 - 6 * number, 4 + 0.5 * up),
            (_PARTING - 17 - 14 * q, 53 - 2 * q, 16 + up - 2 * q),
            (-45 - 18 * q, 31 - 5 * q, 15.5 + up),
            (-62 - 18 * q, 8, 14.5 + up),
            (-71 - 14 * q, -16, 13.5 + 0.7 * up),
            (-70 - 12 * q, -42 - 4 * q, 11 + 0.5 * up),
        ]
        forms.append(lock(scalp, course, 15.5, 7, widest=0.42, start=0.35, end=0.06, rows=18))
    return forms


def _hair(neutral: Head) -> Solid:
    scalp = Scalp(neutral.skin)
    edge = curve(
        (0, 66), (16, 67), (34, 76), (52, 80), (75, 90), (100, 106), (130, 118), (180, 122)
    )
    under, ridge = cap(
        scalp,
        edge,
        lambda azimuth, along: 11 + 4 * np.exp(-((azimuth / 70) ** 2)),
        ridge=0.6,
        ridges=30,
        swirl=0.1,
        rows=14,
    )
    locks = _curtain(scalp) + _fringe(scalp)
    # In front the scalp lies in the shadow of the fringe.
    scalp_colours = mix(shaded(under, _DARK, _LIGHT, ridge), _SHADOW, ramp(-30, 20, under[0][:, 2]))
    colours = [scalp_colours, *(shaded(f, _DARK, _LIGHT) for f in locks)]
    return Solid("hair", "hair", *merged([under, *locks]), np.concatenate(colours))


def _dress(neutral: Head) -> Sequence[Solid]:
    return (
        *pair(ear(EarShape(height=25, width=14.5, root=(70, 11, -24)), _SKIN, (0.62, 0.28, 0.22))),
        _hair(neutral),
        bust((0.78, 0.30, 0.22), (0.85, 0.38, 0.28)),
    )


_KEYS = repertoire(
    **TOLD_APART,
    smile={"corner": (10.5, 10.0, -5.0)},
    sad={"brow_inner": (-3.0, 9.5, 1.0), "lid_tilt": 3.0},
    disgust={"nose": 6.0},
)

WOMAN = Sculpture(
    name="woman",
    proportions=_PROPORTIONS,
    paint=lambda head: paint_skin(
        head,
        _SKIN,
        (0.78, 0.26, 0.20),
        (0.70, 0.20, 0.22),
        lids=(0.48, 0.24, 0.20),
        blush_amount=0.75,
    ),
    eyes=ball_eyes(Iris((0.22, 0.10, 0.05), (0.55, 0.30, 0.12), 0.56, 0.26)),
    dress=_dress,
    keys=_KEYS,
    examples=EXAMPLES,
    brow=(0.10, 0.05, 0.04),
    lash=(0.05, 0.03, 0.03),
)
