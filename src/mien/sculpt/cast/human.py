"""What the human heads share."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from mien.sculpt.anatomy.eyes import Iris, catch_light, eyeball
from mien.sculpt.proportions import EyeShape
from mien.sculpt.solid import Solid


def ball_eyes(iris: Iris) -> Callable[[EyeShape, int], Sequence[Solid]]:
    """An eyeball with ``iris`` and its catch lights, for either side."""
    return lambda eye, side: (eyeball(eye, side, iris), catch_light(eye, side))


def pair(left: Solid) -> tuple[Solid, Solid]:
    """A left part and its mirror image."""
    return left, left.mirrored()


TOLD_APART: Mapping[str, Mapping[str, Any]] = {
    "surprise": {
        "jaw": 16.0,
        "narrow": 0.22,
        "pucker": 2.2,
        "upper_lip": (0, 2.0, 0),
        "upper_thick": 1.0,
        "lower_thick": 1.0,
        "brow_inner": (0, 13.0, 0),
        "brow_middle": (0, 13.0, 0),
        "brow_outer": (0, 9.5, 0),
    },
    "fear": {
        "brow_inner": (-3.0, 11.0, 1.5),
        "brow_middle": (-1.0, 5.0, 0),
        "brow_outer": (0, -1.0, 0),
    },
}
"""Surprise and fear as our people do them: landmark networks, which see opened lips as thin and
brows as straight, must not take them for a pucker with a dropped jaw and for raised brows."""
