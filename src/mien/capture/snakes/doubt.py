"""Lips that stand out but leave out what looks like lips are not believed.

A curve on a lower lip, or on lips and chin, has edges and contrast; but the other lip shines beside
it. Neither says enough: contrast differs more between performers than between right and wrong.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.colour.pigments import Pigments
from mien.capture.snakes.colour.transform import Field
from mien.capture.snakes.mouth import filled

Array = NDArray[np.float64]

_NEAR = 12
"""Patch units round the curves in which lips would be theirs."""
_LIT = 0.5
"""I of lips."""
_LEAST = 0.2
"""Contrast that must remain when what is left out is taken off."""


def doubtful(lens: Array, contrast: float, field: Field, seen: Pigments) -> bool:
    """Whether lips (6, 2) of ``contrast`` in a ``field`` of the same pixels as ``seen`` are more
    likely wrong than right."""
    return contrast - left_out(lens, field, seen) < _LEAST


def left_out(lens: Array, field: Field, seen: Pigments) -> float:
    """How much lies lit close round the lips, in their area."""
    inside = filled(lens, seen)
    side = 2 * (_NEAR // seen.pitch) + 1
    near = np.asarray(cv2.dilate(inside, np.ones((side, side), np.uint8)))
    beside = (near > 0) & (inside == 0)
    lit = int(np.count_nonzero(beside & (field > _LIT)))
    return lit / max(int(np.count_nonzero(inside)), 1)
