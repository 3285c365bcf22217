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

    def values(self, plane: Field, places: Array) -> Field:
        """(...) of one of the planes at the pixels nearest to places (..., 2) in patch units."""
        row = np.ascontiguousarray(places).reshape(-1, 2)
        return np.asarray(_nearest(plane, row, self.corner, self.pitch)).reshape(places.shape[:-1])


def pigments(patch: Picture, gains: Array, window: Box, pitch: int) -> Pigments:
    """Those of the columns and rows ``window`` (left, top, right, bottom) of a patch whose pixels
    are ``pitch`` patch units apart."""
    left, top, _, _ = window
    first = pitch * np.array([left, top]) + 0.5 * (pitch - 1) - ORIGIN
    planes = _planes(patch, gains.astype(np.float32), window)
    return Pigments(*planes, first, pitch)


@njit(cache=True, nogil=True)
def _nearest(plane: Field, places: Array, corner: Array, pitch: float) -> Field:
    rows, columns = plane.shape
    found = np.empty(len(places), dtype=np.float32)
    for n in range(len(places)):
        column = int(np.rint((places[n, 0] - corner[0]) / pitch))
        row = int(np.rint((places[n, 1] - corner[1]) / pitch))
        found[n] = plane[min(max(row, 0), rows - 1), min(max(column, 0), columns - 1)]
    return found


@njit(cache=True, nogil=True, fastmath=True)
def _planes(patch: Picture, gains: Field, window: Box) -> tuple[Field, Field, Field]:
    left, top, right, bottom = window
    shape = bottom - top, right - left
    value, magenta = np.empty(shape, np.float32), np.empty(shape, np.float32)
    blue = np.empty(shape, np.float32)
    faintest = np.float32(_FAINTEST)
    for y in range(bottom - top):
        # Flat, so that the compiler knows how far pixels are apart: it then does several at once.
        flat = patch[top + y].reshape(-1)[3 * left :]
        for x in range(right - left):
            green, tint = flat[3 * x + 1] * gains[1], flat[3 * x + 2] * gains[2]
            most = max(flat[3 * x] * gains[0], green, tint)
            value[y, x] = most
            magenta[y, x] = np.float32(1.0) - green / max(most, faintest)
            blue[y, x] = tint / max(green, faintest)
    return value, magenta, blue
