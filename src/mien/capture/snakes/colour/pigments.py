"""The plain colours of a part of a patch under the skin's own light: what the mouth is told by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.capture.snakes.colour.transform import Box, Field
from mien.capture.snakes.head.patch import ORIGIN, Picture

Array = NDArray[np.float64]

_FAINTEST = 0.25


@dataclass(frozen=True, slots=True)
class Pigments:
    """Colours of a window of a patch."""

    value: Field
    """(H, W) V = max(R, G, B)."""
    magenta: Field
    """(H, W) (V - G) / V, 0..1."""
    blue: Field
    """(H, W) B / G."""
    corner: Array
    """(2,) patch units of the first pixel's centre."""
    pitch: int
    """Patch units from one pixel to the next."""

    def pixels(self, places: Array) -> Array:
        """(..., 2) columns and rows of places (..., 2) in patch units."""
        return np.asarray((places - self.corner) / self.pitch)

    def nearest(self, places: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Rows and columns of the pixels nearest to places (..., 2) in patch units."""
        columns, rows = np.moveaxis(np.rint(self.pixels(places)).astype(np.intp), -1, 0)
        height, width = self.value.shape
        return np.clip(rows, 0, height - 1), np.clip(columns, 0, width - 1)


def pigments(patch: Picture, gains: Array, window: Box, pitch: int) -> Pigments:
    """Those of the columns and rows ``window`` (left, top, right, bottom) of a patch whose pixels
    are ``pitch`` patch units apart."""
    left, top, right, bottom = window
    first = pitch * np.array([left, top]) + 0.5 * (pitch - 1) - ORIGIN
    planes = _planes(patch[top:bottom, left:right], gains.astype(np.float32))
    return Pigments(*planes, first, pitch)


@njit(cache=True, nogil=True, fastmath=True)
def _planes(patch: Picture, gains: Field) -> tuple[Field, Field, Field]:
    rows, columns, _ = patch.shape
    value = np.empty((rows, columns), dtype=np.float32)
    magenta = np.empty((rows, columns), dtype=np.float32)
    blue = np.empty((rows, columns), dtype=np.float32)
    faintest = np.float32(_FAINTEST)
    for y in range(rows):
        for x in range(columns):
            r, g, b = (
                patch[y, x, 0] * gains[0],
                patch[y, x, 1] * gains[1],
                patch[y, x, 2] * gains[2],
            )
            most = max(r, g, b)
            value[y, x] = most
            magenta[y, x] = np.float32(1.0) - g / max(most, faintest)
            blue[y, x] = b / max(g, faintest)
    return value, magenta, blue
