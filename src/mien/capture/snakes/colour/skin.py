"""The colour of the skin, by which all other colours are judged."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.head.patch import ORIGIN, WIDTH, Picture

Array = NDArray[np.float64]

USUAL_SKIN = np.array([200.0, 150.0, 125.0])
"""Every picture's channels are scaled until its skin has this colour: what light and camera do
to all colours alike is undone, and one table of colours serves all skins."""

_SPACING = 3
_ZONES = ((-75, 38, -38, 72), (38, 38, 75, 72), (-12, 8, 12, 45))
"""Left, top, right, bottom of the cheeks and the bridge of the nose, patch units."""
_DARKEST = 4.0
"""Channels below are noise, whatever the light."""


def _sampled() -> NDArray[np.intp]:
    """Where the samples are in the row of all pixels of a patch."""
    places = [
        np.mgrid[top:bottom:_SPACING, left:right:_SPACING].reshape(2, -1)
        for left, top, right, bottom in _ZONES
    ]
    rows, columns = np.concatenate(places, axis=1)
    return np.asarray((rows + int(ORIGIN[1])) * WIDTH + columns + int(ORIGIN[0]))


_SAMPLED = _sampled()


def skin_colour(patch: Picture) -> Array:
    """(3,) median of R, G, B over cheeks and bridge: glints, moles and glasses do not count."""
    middle = len(_SAMPLED) // 2
    colours = np.partition(patch.reshape(-1, 3).take(_SAMPLED, axis=0), middle, axis=0)[middle]
    return np.asarray(np.maximum(colours, _DARKEST))


def gains(skin: Array) -> Array:
    """(3,) factors that bring ``skin`` to USUAL_SKIN."""
    return np.asarray(USUAL_SKIN / skin)
