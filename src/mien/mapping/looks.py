"""Eyes that are turned by key models, not by nodes: painted on, as VRM has them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_FULL = np.radians(35.0)
"""Gaze angle at which such a key model is at 1."""


def look(weights: Array, names: Sequence[str], looks: Mapping[str, str], gaze: Array) -> Array:
    """Weights (F, W) of key models ``names`` (W) with those in ``looks`` ("left", "right", "up",
    "down", the subject's) set by the mean of both eyes' ``gaze`` (F, 2, 2), radians."""
    yaw, pitch = np.moveaxis(gaze.mean(axis=1) / _FULL, -1, 0)
    levels = {"left": yaw, "right": -yaw, "up": pitch, "down": -pitch}
    seen = weights.copy()
    for way, key in looks.items():
        if key in names:
            seen[:, list(names).index(key)] = np.clip(levels[way], 0.0, 1.0)
    return seen
