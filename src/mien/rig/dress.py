"""Colours for what a file leaves bare, so that a face can be read: skin, and eyes that look."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mien.face.face import Array
from mien.rig.components import Ball

_SKIN = (0.5, 0.32, 0.23)
_WHITE, _IRIS, _PUPIL = (0.75, 0.75, 0.74), (0.07, 0.12, 0.2), (0.01, 0.01, 0.01)
_BARE = 0.05
"""Linear light by which the colours of a thing differ, that is painted by nobody."""
_HIDDEN = np.radians(10.0)
"""Angle aside of the middle of its lids at which an iris begins to hide."""
_EDGES = (0.84, 0.93)
"""Cosines of the angle about the line of sight where the iris and the pupil begin."""


def dressed(colours: Array, vertices: Array, balls: Sequence[Ball]) -> Array:
    """``colours`` (V, 3) linear RGB of ``vertices`` (V, 3), upright and facing +z, with what is
    bare painted."""
    painted = colours.copy()
    if np.ptp(colours, axis=0).max() < _BARE:
        painted[:] = _SKIN
    for ball in balls:
        own = ball.vertices
        if np.ptp(colours[own], axis=0).max() < _BARE:
            away = vertices[own] - ball.centre
            # Eyes of a prey animal look aside: an iris straight ahead would hide behind their lids.
            turn = np.sign(ball.aside) * max(abs(ball.aside) - _HIDDEN, 0.0)
            line = np.array([np.sin(turn), 0.0, np.cos(turn)])
            ahead = away @ line / np.maximum(np.linalg.norm(away, axis=1), 1e-9)
            painted[own] = np.select(
                [(ahead > _EDGES[1])[:, None], (ahead > _EDGES[0])[:, None]],
                [np.array(_PUPIL), np.array(_IRIS)],
                np.array(_WHITE),
            )
    return painted
