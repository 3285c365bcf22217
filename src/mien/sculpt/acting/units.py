"""Single movements: what the capture fits to a performer, what editors add to a character, and
Apple's 52."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from mien.sculpt.acting.expression import Expression
from mien.sculpt.acting.expressions import KEYS

E = Expression

_SMILE = E(
    corner=(8.0, 8.0, -4.5),
    upper_lip=(0, 0.5, -0.8),
    lower_lip=(0, 0.6, -0.5),
    upper_thick=0.88,
    lower_thick=0.88,
    cheek=(2.0, 3.0, 3.5),
    fold=1.2,
)
_FROWN = E(corner=(0, -8.0, -1.0), upper_lip=(0, -0.3, 0), lower_lip=(0, 0, 0), chin=2.0)
_BROWS_DOWN = E(
    brow_inner=(-4.0, -7.0, 2.0), brow_middle=(-2.0, -5.5, 1.0), brow_outer=(0, -2.5, 0)
)
_INNER_UP = E(brow_inner=(-1.5, 8.5, 0.5), brow_middle=(0, 2.5, 0))
_OUTER_UP = E(brow_middle=(0, 5.5, 0), brow_outer=(0, 8.0, 0))
_UPPER_UP = E(upper_lip=(0, 4.5, 1.0), upper_quarter=(0, 3.4, 0), nose=1.2, fold=0.8)
_LOWER_DOWN = E(lower_lip=(0, -4.5, 0.5), lower_quarter=(0, -3.4, 0))
_SNEER = E(
    nose=5.0,
    upper_lip=(0, 1.8, 0.8),
    upper_quarter=(0, 1.6, 0),
    cheek=(0.5, 2.5, 2.0),
    brow_inner=(-2.0, -3.0, 1.0),
)
_FUNNEL = E(
    jaw=3.0,
    narrow=0.26,
    pucker=6.0,
    upper_lip=(0, 2.4, 0),
    lower_lip=(0, -3.2, 0),
    upper_quarter=(0, 2.0, 0),
    lower_quarter=(0, -2.4, 0),
    upper_thick=1.3,
    lower_thick=1.3,
)
_MOUTH_LEFT = E(lips_aside=7.0)
_SQUINT = E(squint=0.95, blink=0.14, cheek=(0, 3.0, 2.0), brow_middle=(0, -1.0, 0))
_PUFF = E(puff=9.0, upper_lip=(0, 0, 1.2), lower_lip=(0, 0, 1.2))

UNITS: Mapping[str, Expression] = {
    "brows_down": _BROWS_DOWN,
    "brow_inner_up": _INNER_UP,
    "upper_lip_up": _UPPER_UP,
    "lower_lip_down": _LOWER_DOWN,
    "mouth_left": _MOUTH_LEFT,
    "mouth_right": _MOUTH_LEFT.mirrored(),
    "smile_left": _SMILE.sides(1, 0),
    "smile_right": _SMILE.sides(0, 1),
    "frown": _FROWN,
    "funnel": _FUNNEL,
    "nose_wrinkle": _SNEER,
    "squint": _SQUINT,
    "cheek_puff": _PUFF,
}
"""With KEYS, what the capture fits to a performer."""

_SIDED: Mapping[str, Expression] = {
    "eyeBlink": E(blink=1),
    "eyeLookDown": E(blink=0.38, squint=-0.25),
    "eyeLookIn": E(lid_aside=-1.4),
    "eyeLookOut": E(lid_aside=1.4),
    "eyeLookUp": E(blink=-0.22, squint=0.18),
    "eyeSquint": E(squint=0.8, blink=0.06),
    "eyeWide": E(blink=-0.36, squint=-0.25),
    "mouthSmile": _SMILE,
    "mouthFrown": _FROWN,
    "mouthDimple": E(corner=(3.0, 0.8, -6.0), fold=1.0),
    "mouthStretch": E(corner=(8.5, -2.0, -4.5), lower_quarter=(0, -0.8, 0), fold=0.6),
    "mouthPress": E(
        upper_thick=0.62,
        lower_thick=0.62,
        upper_lip=(0, -0.2, -1.0),
        lower_lip=(0, 0.4, -1.0),
        corner=(1.0, 0.6, -1.0),
    ),
    "mouthLowerDown": _LOWER_DOWN,
    "mouthUpperUp": _UPPER_UP,
    "browDown": _BROWS_DOWN,
    "browOuterUp": _OUTER_UP,
    "cheekSquint": E(cheek=(1.5, 5.0, 4.5), squint=0.3, fold=0.6),
    "noseSneer": _SNEER,
}

_TONGUE_OUT = E(
    tongue=30.0, jaw=5.0, lower_lip=(0, -1.5, 0), upper_lip=(0, 0.8, 0), lower_thick=0.9
)

EXTRAS: Mapping[str, Expression] = {
    "smile_left": _SMILE.sides(1, 0),
    "smile_right": _SMILE.sides(0, 1),
    "brow_up_left": KEYS["brows_up"].sides(1, 0),
    "brow_up_right": KEYS["brows_up"].sides(0, 1),
    "brow_down_left": _BROWS_DOWN.sides(1, 0),
    "brow_down_right": _BROWS_DOWN.sides(0, 1),
    "sneer_left": _SNEER.sides(1, 0),
    "sneer_right": _SNEER.sides(0, 1),
    "cheek_puff": _PUFF,
    "tongue_out": _TONGUE_OUT,
    "jaw_left": E(jaw_aside=7.0),
    "jaw_right": E(jaw_aside=-7.0),
    "lips_in": E(
        upper_thick=0.4, lower_thick=0.4, upper_lip=(0, -0.4, -2.0), lower_lip=(0, 0.4, -2.0)
    ),
}
"""What every character has besides, for editing."""

ARKIT: Mapping[str, Expression] = {
    **{
        name + side: expression.sides(*gain)
        for name, expression in _SIDED.items()
        for side, gain in (("Left", (1.0, 0.0)), ("Right", (0.0, 1.0)))
    },
    "jawForward": E(jaw_forward=6.0),
    "jawLeft": EXTRAS["jaw_left"],
    "jawRight": EXTRAS["jaw_right"],
    "jawOpen": KEYS["jaw_open"],
    "mouthClose": replace(KEYS["jaw_open"], close=1.0),
    "mouthFunnel": _FUNNEL,
    "mouthPucker": KEYS["pucker"],
    "mouthLeft": _MOUTH_LEFT,
    "mouthRight": _MOUTH_LEFT.mirrored(),
    "mouthRollLower": E(lower_thick=0.4, lower_lip=(0, 0.6, -2.2), lower_quarter=(0, 0.3, -0.8)),
    "mouthRollUpper": E(upper_thick=0.4, upper_lip=(0, -0.4, -2.0), upper_quarter=(0, 0, -0.8)),
    "mouthShrugLower": E(
        lower_lip=(0, 2.6, 2.0), upper_lip=(0, 2.4, 1.0), lower_thick=1.2, chin=5.0
    ),
    "mouthShrugUpper": E(upper_lip=(0, 2.6, 2.0), upper_quarter=(0, 1.4, 0), upper_thick=1.15),
    "browInnerUp": _INNER_UP,
    "cheekPuff": _PUFF,
    "tongueOut": _TONGUE_OUT,
}
"""Apple's 52, for faces that are driven under those names; each adds to the others."""

STARTS: Mapping[str, Expression] = {"mouthClose": KEYS["jaw_open"]}
"""Key models that are the way from another pose: mouthClose goes with as much of jawOpen."""
