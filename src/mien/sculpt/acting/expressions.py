"""The key models, as an animator would note them down. Characters change them to their temper."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from mien.sculpt.acting.expression import Expression

E = Expression

EXAMPLES = (
    "smile",
    "sad",
    "anger",
    "surprise",
    "disgust",
    "fear",
    "blink_left",
    "blink_right",
    "brows_up",
    "jaw_open",
    "pucker",
    "wide",
    "pressed",
)
"""The thirteen of [B], which every character has."""

_BLINK = E(blink=1, brow_inner=(0, -0.6, 0), brow_middle=(0, -0.8, 0), brow_outer=(0, -0.6, 0))

KEYS: Mapping[str, Expression] = {
    # Lips stay shut: a smile that opens the mouth cannot follow a shut one.
    "smile": E(
        corner=(9.5, 9.0, -5.0),
        upper_lip=(0, 0.7, -1.0),
        lower_lip=(0, 0.65, -0.6),
        upper_quarter=(0, 0.1, 0),
        lower_quarter=(0, -0.15, 0),
        upper_thick=0.86,
        lower_thick=0.86,
        cheek=(2.5, 5.0, 5.0),
        fold=1.4,
        squint=0.40,
        blink=0.05,
        brow_inner=(0, 1.0, 0),
        brow_middle=(0, 1.8, 0),
        brow_outer=(0, 1.4, 0),
    ),
    "sad": E(
        lid_tilt=2.4,
        blink=0.22,
        squint=0.08,
        brow_inner=(-2.5, 8.5, 1.0),
        brow_middle=(0, 1.5, 0),
        brow_outer=(0, -4.5, 0),
        corner=(-1.0, -7.5, -1.0),
        upper_lip=(0, 0.9, 0),
        lower_lip=(0, 1.2, 1.4),
        upper_thick=0.95,
        lower_thick=0.95,
        chin=4.0,
    ),
    "anger": E(
        lid_tilt=-2.6,
        blink=0.12,
        squint=0.38,
        brow_inner=(-4.5, -8.5, 2.5),
        brow_middle=(-2.5, -3.5, 1.0),
        brow_outer=(0, 3.0, 0),
        corner=(1.0, -4.0, -1.0),
        upper_lip=(0, 1.2, 1.0),
        lower_lip=(0, 1.4, 1.2),
        upper_quarter=(0, 0.8, 0),
        lower_quarter=(0, 0.6, 0),
        upper_thick=0.80,
        lower_thick=0.80,
        nose=3.2,
        chin=2.0,
        cheek=(0, 1.5, 1.0),
    ),
    "surprise": E(
        jaw=15,
        narrow=0.16,
        pucker=1.4,
        upper_lip=(0, 0.6, 0),
        corner=(-2.0, 0.6, 0),
        lower_quarter=(0, -1.6, 0),
        upper_quarter=(0, 1.2, 0),
        upper_thick=1.28,
        lower_thick=1.28,
        brow_inner=(0, 11.5, 0),
        brow_middle=(0, 10.0, 0),
        brow_outer=(0, 7.0, 0),
        blink=-0.36,
        squint=-0.25,
    ),
    "disgust": E(
        jaw=2.0,
        lid_tilt=-1.2,
        blink=0.2,
        squint=0.55,
        nose=5.0,
        upper_lip=(0, 4.2, 1.5),
        upper_quarter=(0, 3.4, 0),
        lower_lip=(0, 0.4, 1.0),
        corner=(1.0, -1.5, -1.0),
        cheek=(1.0, 5.0, 4.0),
        fold=1.6,
        brow_inner=(-3.0, -5.5, 2.0),
        brow_middle=(-1.0, -2.0, 0),
    ),
    "fear": E(
        jaw=6.5,
        corner=(7.5, -4.0, -4.5),
        upper_lip=(0, 0.8, 0),
        lower_lip=(0, -1.0, 0),
        lower_quarter=(0, -2.6, 0),
        upper_thick=0.95,
        lower_thick=0.9,
        brow_inner=(-3.5, 9.5, 1.0),
        brow_middle=(0, 4.5, 0),
        brow_outer=(0, -1.5, 0),
        lid_tilt=1.4,
        blink=-0.32,
        squint=-0.05,
    ),
    "blink_left": replace(_BLINK, right=0),
    "blink_right": replace(_BLINK, left=0),
    "brows_up": E(brow_inner=(0, 10.5, 0), brow_middle=(0, 10.5, 0), brow_outer=(0, 8.0, 0)),
    "jaw_open": E(jaw=20, lower_quarter=(0, -2.0, 0), upper_thick=1.03, lower_thick=1.05),
    "pucker": E(
        narrow=0.42,
        pucker=7.5,
        corner=(0, 0, 3.0),
        upper_thick=1.45,
        lower_thick=1.45,
        cheek=(-2.5, 0, -1.5),
    ),
    "wide": E(
        jaw=4.0,
        corner=(8.5, 1.0, -5.5),
        upper_lip=(0, 1.4, -1.0),
        upper_quarter=(0, 1.0, 0),
        lower_lip=(0, -0.8, -1.0),
        lower_quarter=(0, -2.2, 0),
        upper_thick=0.88,
        lower_thick=0.88,
        cheek=(1.5, 2.0, 2.0),
        fold=0.8,
    ),
    "pressed": E(
        corner=(2.0, 0.4, -1.5),
        upper_lip=(0, -0.3, -1.4),
        lower_lip=(0, 0.2, -1.4),
        upper_thick=0.52,
        lower_thick=0.52,
        chin=2.0,
    ),
    "laugh": E(
        jaw=12,
        corner=(9.5, 9.5, -5.0),
        upper_lip=(0, 3.0, -1.0),
        upper_quarter=(0, 1.6, -0.6),
        lower_quarter=(0, -3.0, 0),
        upper_thick=0.84,
        lower_thick=0.9,
        cheek=(2.5, 6.0, 6.0),
        fold=1.8,
        squint=0.6,
        blink=0.2,
        brow_inner=(0, 1.6, 0),
        brow_middle=(0, 2.8, 0),
        brow_outer=(0, 2.4, 0),
    ),
}
"""The thirteen and a laugh."""


def tempered(
    keys: Mapping[str, Expression], changes: Mapping[str, Mapping[str, Any]]
) -> dict[str, Expression]:
    """``keys`` with some fields of some of them changed: a character's own way."""
    return {name: replace(expression, **changes.get(name, {})) for name, expression in keys.items()}
