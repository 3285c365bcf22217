"""The monkey: muzzle, brow ridge, round ears; all mouth."""

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
from mien.sculpt.brush import bump, ramp
from mien.sculpt.cast.human import TOLD_APART, ball_eyes, pair
from mien.sculpt.colour import (
    linear,
    mix,
    paint_lid_edges,
    paint_lips,
    paint_mouth,
    paint_nostrils,
)
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

Array = NDArray[np.float64]

_FUR, _FACE = (0.33, 0.19, 0.115), (0.86, 0.64, 0.47)
_DARK, _LIGHT = (0.24, 0.13, 0.08), (0.50, 0.30, 0.18)

_PROPORTIONS = Proportions(
    HeadShape(
        cranium=(1.0, 0.96, 1.0),
        crown=4.0,
        face_width=1.05,
        jaw_width=1.02,
        midface=0.90,
        lower_face=0.88,
        chin_up=-2,
        chin_forward=16,
        nose=(1.12, 0.58, 0.38),
        nose_up=3,
        neck=0.72,
        brushes=(
            Brush((0, -36, 58), (40, 30, 52), (0.0, 1, 20)),
            Brush((24, -34, 58), (24, 24, 40), (6, 0, 8)),
            Brush((22, 50, 46), (26, 11, 34), (0, 1, 8)),
            Brush((0, 44, 50), (14, 10, 30), (0, 0, -1)),
        ),
    ),
    EyeShape(
        aside=25.5,
        height=26,
        depth=31,
        radius=19.5,
        half_width=19.3,
        upper=11.5,
        lower=9.5,
        tilt=0.3,
        lid_turn=6.0,
        offset=2.5,
    ),
    MouthShape(
        half_width=27,
        height=-37,
        depth=84,
        corner_depth=60,
        upper=4.8,
        lower=6.2,
        fullness=2.4,
        bend=5.0,
        tooth_scale=1.28,
        tooth_back=14.5,
    ),
    HairLine(
        brow_up=5.0, brow_width=2.9, brow_height=1.8, brow_between=0.45, brow_inner=2.2, lash=1.3
    ),
    Temper(brows=1.15, lip_thickness=1.5),
)


def _bare(head: Head) -> Array:
    """1 on the hairless face: two rounds about the eyes and one about the mouth."""
    skin, eye, mouth = head.skin, head.proportions.eye, head.proportions.mouth
    aside = np.abs(skin[:, 0])
    eyes = np.hypot((aside - eye.aside - 2) / 34, (skin[:, 1] - eye.height - 8) / 41)
    muzzle = np.hypot(aside / 54, (skin[:, 1] - mouth.height) / 42)
    rim = np.where(skin[:, 2] < -2, 2.0, np.minimum(eyes, muzzle))
    amount = np.clip((1.12 - rim) / 0.34, 0, 1)
    return np.asarray(amount**2 * (3 - 2 * amount) * (labels().mask > 0.5))


def _paint(head: Head) -> Array:
    skin, eye = head.skin, head.proportions.eye
    colours = np.tile(linear(_FUR), (len(skin), 1))
    bare = _bare(head)
    colours = mix(colours, _FACE, bare)
    cheek = bump(skin, (eye.aside + 8, eye.height - 34, 50), (18, 12, 40))
    colours = mix(colours, (0.80, 0.42, 0.34), 0.30 * cheek * bare)
    colours = mix(colours, (0.62, 0.36, 0.27), 0.55 * labels().eye_area * bare)
    colours = paint_lips(colours, (0.56, 0.27, 0.22))
    colours = paint_mouth(colours, head)
    colours = paint_lid_edges(colours, (0.45, 0.22, 0.18))
    return paint_nostrils(colours, head, (4.5, 3.0, 8.0), (0.20, 0.09, 0.07), 0.9)


def _tufts(scalp: Scalp) -> list[Form]:
    """A forelock that falls forward from the crown."""
    forms = []
    for yaw, lean, size in (
        (-26, -9, 0.75), (22, 11, 0.85), (-13, -2, 0.95), (11, 6, 1.05), (-1, 1, 1.15),
    ):  # fmt: skip
        h = 20 * size
        course = [
            (1.3 * yaw, 66, -3),
            (1.1 * yaw, 67, 0.5 * h),
            (0.9 * yaw + 0.4 * lean, 64, 1.0 * h),
            (0.8 * yaw + 1.0 * lean, 57, 1.3 * h),
            (0.8 * yaw + 1.8 * lean, 48, 1.15 * h),
            (0.9 * yaw + 2.6 * lean, 41, 0.7 * h),
        ]
        forms.append(lock(scalp, course, 11.5, 7, rows=14, widest=0.38, start=0.7, end=0.02))
    return forms


def _fur(neutral: Head) -> Solid:
    scalp = Scalp(neutral.skin)
    edge = curve(
        (0, 88), (14, 92), (30, 86), (50, 80), (62, 84), (75, 88), (88, 94), (100, 112),
        (115, 126), (130, 130), (155, 128), (180, 126),
    )  # fmt: skip
    hood, ridge = cap(
        scalp,
        edge,
        lambda azimuth, along: 7.0 - 4.5 * ramp(0.55, 1.0, along),
        ridge=0.45,
        ridges=41,
        swirl=0.2,
        zigzag=2.8,
        teeth=25,
        around=150,
        rows=18,
        sink=2.0,
    )
    tufts = merged(_tufts(scalp))
    # Towards its edge the hood takes on the colour of the short fur it grows out of.
    along = np.append(0, np.repeat(np.linspace(0, 1, 18)[1:], 150))
    colours = mix(shaded(hood, _DARK, _LIGHT, ridge), _FUR, 0.85 * ramp(0.45, 0.95, along))
    colours = np.concatenate([colours, shaded(tufts, _DARK, _LIGHT)])
    return Solid("hair", "fur", *merged([hood, tufts]), colours)


def _dress(neutral: Head) -> Sequence[Solid]:
    shape = EarShape(height=27, width=25, root=(75, 20, -26), flare=62, tilt=0, round=True)
    return (
        *pair(ear(shape, (0.42, 0.25, 0.16), (0.84, 0.60, 0.46))),
        _fur(neutral),
        bust((0.86, 0.66, 0.22), (0.93, 0.78, 0.36)),
    )


# The muzzle stretches over the teeth: lips that go back would let them through. What networks
# trained on people take for a person's opened mouth is narrow and has thin lips.
_KEYS = repertoire(
    smile={
        "upper_lip": (0, 0.7, 0.6),
        "lower_lip": (0, 0.65, 1.0),
        "upper_thick": 0.85,
        "lower_thick": 0.85,
        "fold": 1.0,
    },
    sad={"corner": (-1.0, -9.5, -1.0), "upper_thick": 1.05, "lower_thick": 1.05},
    pressed={
        "upper_lip": (0, -0.1, -0.2),
        "lower_lip": (0, 0, 0.2),
        "upper_thick": 0.62,
        "lower_thick": 0.62,
    },
    lips_in={
        "upper_lip": (0, -0.4, 0),
        "lower_lip": (0, 0.4, 0),
        "upper_thick": 0.7,
        "lower_thick": 0.7,
    },
    viseme_p={
        "upper_lip": (0, -0.1, 0),
        "lower_lip": (0, 0, 0),
        "upper_thick": 0.78,
        "lower_thick": 0.78,
    },
    disgust={"upper_lip": (0, 4.8, 2.0), "jaw": 3.0},
    surprise={
        **TOLD_APART["surprise"],
        "narrow": 0.36,
        "pucker": 4.0,
        "upper_lip": (0, 3.0, 0),
        "upper_thick": 0.9,
        "lower_thick": 0.9,
    },
    fear={**TOLD_APART["fear"], "upper_lip": (0, 2.2, 0), "lower_lip": (0, -1.8, 0)},
    anger={"upper_thick": 0.92, "lower_thick": 0.92},
    pucker={"pucker": 9.0},
    jaw_open={
        "narrow": 0.2,
        "upper_lip": (0, 2.5, 0),
        "upper_thick": 0.9,
        "lower_thick": 0.9,
    },
)

MONKEY = Sculpture(
    name="monkey",
    proportions=_PROPORTIONS,
    paint=_paint,
    eyes=ball_eyes(Iris((0.20, 0.09, 0.04), (0.60, 0.33, 0.12), 0.60, 0.30)),
    dress=_dress,
    keys=_KEYS,
    examples=EXAMPLES,
    brow=(0.20, 0.10, 0.06),
    lash=(0.10, 0.05, 0.04),
)
