"""The garment a head stands in."""

from __future__ import annotations

import numpy as np

from mien.sculpt.colour import Colour, linear
from mien.sculpt.solid import Solid, fan, outward, sheet

_PROFILE = (
    (-24.0, 33.0, 34.0),
    (-7.0, 38.0, 39.0),
    (0.0, 43.0, 44.0),
    (3.0, 47.0, 48.0),
    (1.5, 51.0, 52.0),
    (-3.0, 52.5, 54.0),
    (-8.0, 56.0, 55.0),
    (-16.0, 72.0, 58.0),
    (-28.0, 92.0, 63.0),
    (-44.0, 114.0, 68.0),
    (-62.0, 122.0, 71.0),
    (-80.0, 123.0, 70.0),
    (-96.0, 112.0, 66.0),
    (-106.0, 92.0, 56.0),
    (-110.0, 48.0, 30.0),
)
"""Height over the collar's root, half width and half depth of each row, from inside the neck."""
_COLLAR_ROWS = 6
_AROUND = 40
_TOP, _DEPTH = -114.0, -58.0


def bust(cloth: Colour, collar: Colour, narrow: float = 1.0) -> Solid:
    """Shoulders in ``cloth`` with a ``collar``."""
    angle = np.linspace(0, 2 * np.pi, _AROUND, endpoint=False)
    rows = []
    for down, wide, deep in _PROFILE:
        fall = np.clip(-down / 40, 0, 1) if wide > 50 else 0.0
        width = narrow + (1 - narrow) * fall
        rows.append(
            np.stack(
                [
                    wide * width * np.sin(angle),
                    _TOP + down - 6 * np.cos(angle) * (1 - fall),
                    _DEPTH + 4 * fall + deep * width * np.cos(angle),
                ],
                axis=1,
            )
        )
    vertices = np.vstack([*rows, [[0, _TOP - 111, _DEPTH + 4]]])
    last = len(vertices) - 1 - _AROUND
    floor = fan(len(vertices) - 1, last, _AROUND)[:, ::-1]
    triangles = np.concatenate([sheet(len(_PROFILE), _AROUND), floor])
    vertices, triangles = outward(vertices, triangles, (0, _TOP - 40, _DEPTH))
    colours = np.tile(linear(cloth), (len(vertices), 1))
    colours[: _COLLAR_ROWS * _AROUND] = linear(collar)
    return Solid("bust", "cloth", vertices, triangles, colours, follows="body")
