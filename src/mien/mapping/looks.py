"""Eyes that are turned by key models, not by nodes: painted on, as VRM has them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from mien.performance.curves import Curves

_FULL = np.radians(35.0)
"""Gaze angle at which such a key model is at 1."""


def look(curves: Curves, looks: Mapping[str, str]) -> Curves:
    """``curves`` with the key models in ``looks`` ("left", "right", "up", "down", the subject's)
    added and set by the mean gaze of both eyes."""
    if not looks:
        return curves
    yaw, pitch = np.moveaxis(curves.gaze.mean(axis=1) / _FULL, -1, 0)
    levels = {"left": yaw, "right": -yaw, "up": pitch, "down": -pitch}
    turned = np.stack([np.clip(levels[way], 0.0, 1.0) for way in looks], axis=1)
    return replace(
        curves,
        names=(*curves.names, *looks.values()),
        weights=np.concatenate([curves.weights, turned], axis=1),
    )
