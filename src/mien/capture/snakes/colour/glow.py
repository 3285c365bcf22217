"""Skin that lights up as lips do: how much of I is taken off so that it is lips that stand out.

On soft or reddish pictures half of the lips' rectangle may exceed the contrast's middle, and the
curves then end on the chin. How much lies above it is a trait of performer and picture, but for a
wide mouth; so it is taken from many frames.
"""

from __future__ import annotations

from math import log

import numpy as np

from mien.capture.snakes.colour.transform import CONTRAST, Field

_SHARE = 0.2
"""Of the lips' rectangle: so much of it are lips, at most."""
_BOUNDS = (0.02, 0.9999)
"""Of I where its contrast can be undone."""
_PACE = 0.01
"""Share of one frame in what is known."""


def excess(field: Field, known: float | None) -> float:
    """How much too high the sum under the contrast is in the lips' ``field``: by how much it
    exceeds one half in ``_SHARE`` of it, with what was ``known`` from the frames before. Negative
    where less than that lights up."""
    rank = int((1.0 - _SHARE) * (field.size - 1))
    least, most = _BOUNDS
    level = min(max(float(np.partition(field, rank, axis=None)[rank]), least), most)
    here = CONTRAST * log(level / (1.0 - level))
    return here if known is None else known + _PACE * (here - known)


def dimmed(field: Field, glow: float) -> Field:
    """C(I - glow) where ``field`` is C(I), and ``glow`` is positive."""
    if glow <= 0.0:
        return field
    odds = field * np.float32(np.exp(-glow / CONTRAST))
    return np.asarray(odds / (odds + 1.0 - field))
