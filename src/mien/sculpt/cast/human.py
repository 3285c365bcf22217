"""What the human heads share."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from mien.sculpt.eyes import Iris, catch_light, eyeball
from mien.sculpt.proportions import EyeShape
from mien.sculpt.solid import Solid


def ball_eyes(iris: Iris) -> Callable[[EyeShape, int], Sequence[Solid]]:
    """An eyeball with ``iris`` and its catch lights, for either side."""
    return lambda eye, side: (eyeball(eye, side, iris), catch_light(eye, side))


def pair(left: Solid) -> tuple[Solid, Solid]:
    """A left part and its mirror image."""
    return left, left.mirrored()
