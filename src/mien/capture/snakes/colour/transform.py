"""The colour transformation of [B] eq. 1: features light up, skin goes dark.

    I = C(w1 M + w2 K + w3 V + w4 G(H) + w0),    w3 < 0

    symbol  here
    M       magenta against the skin's: ((V - g) / V - M_skin) / 0.15, within +-2
    K       black against the neighbourhood: ln(mean V of 42 x 42 / V), within -0.6 .. 1.5
    V       brightness against the skin: ln(V / V_skin), within -1.5 .. 0.6
    G(H)    1 where the hue lies on the lips' side of the skin's, 0 on the other
    C       contrast: a sigmoid about 1/2

Colours are first scaled so that the skin is USUAL_SKIN. [B] takes K and V of the same pixel, of
which one is the other's complement; measured against the neighbourhood and against the skin they
say two things. One I for each group of features (brow, eye, lip) instead of one for all: areas
under the curve 0.88-0.99 for eyes against 0.70-0.98, and no weights serve lips and brows alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.capture.snakes.colour.skin import USUAL_SKIN
from mien.capture.snakes.head.patch import COARSE, HEIGHT, ORIGIN, WIDTH, Picture

Array = NDArray[np.float64]
Field = NDArray[np.float32]
Box = tuple[int, int, int, int]

_LEVELS = 1024
"""Steps of the tables for logarithm, hue and contrast."""
_BRIGHTEST = 512.0
"""Scaled brightness is cut here."""
_NEIGHBOURHOOD = 21
"""Pixels of the small patch."""
_HUE_OFFSET = 5.0
"""Degrees below the skin's hue where G is one half."""
_HUE_WIDTH = 2.5
CONTRAST = 0.15

MAGENTA_SKIN = (USUAL_SKIN.max() - USUAL_SKIN[1]) / USUAL_SKIN.max()
HUE_SKIN = 60.0 * (USUAL_SKIN[1] - USUAL_SKIN[2]) / (USUAL_SKIN[0] - USUAL_SKIN[2])

_LOG = np.log(np.maximum(np.arange(_LEVELS + 1) / _LEVELS * _BRIGHTEST, 0.25) / USUAL_SKIN[0])
_LOG = _LOG.astype(np.float32)


@dataclass(frozen=True, slots=True)
class Weights:
    """Weights of one group's transformation."""

    magenta: float
    black: float
    brightness: float
    hue: float
    constant: float

    def __post_init__(self) -> None:
        if self.brightness > 0.0:
            raise ValueError("features are darker than skin: the weight of V is not positive")


USUAL_WEIGHTS = {
    "brow": Weights(0.0, 1.3, -0.1, 0.0, 0.30),
    "eye": Weights(-0.1, 0.4, -0.43, 0.0, 0.08),
    "sclera": Weights(-0.5, 0.0, 0.0, 0.0, 0.05),
    "nostril": Weights(0.0, 0.75, -0.2, 0.0, 0.20),
    "lip": Weights(0.2, 0.06, 0.0, 0.7, 0.06),
}
"""Before any training: about what least squares gives on frontal photographs and films."""


def hue_response(hue: Array) -> Array:
    """G(H): 0..1 for hues in degrees, -180..180."""
    return np.asarray(1.0 / (1.0 + np.exp(-(HUE_SKIN - hue - _HUE_OFFSET) / _HUE_WIDTH)))


def contrast(intensity: Array) -> Array:
    """C(I)."""
    return np.asarray(1.0 / (1.0 + np.exp(-(intensity - 0.5) / CONTRAST)))


_HUES = hue_response(np.linspace(-180.0, 180.0, _LEVELS + 1)).astype(np.float32)
_CONTRASTS = contrast(np.linspace(-1.0, 2.0, _LEVELS + 1)).astype(np.float32)


def brightness(patch: Picture, gains: Array) -> Field:
    """(H, W) V = max(R, G, B) of a patch after scaling."""
    return np.asarray(_brightness(patch, gains.astype(np.float32)))


def neighbourhood(value: Field) -> Field:
    """(H, W) mean brightness round each pixel of the small patch."""
    return np.asarray(cv2.blur(value, (_NEIGHBOURHOOD, _NEIGHBOURHOOD)))


def transform(
    patch: Picture, gains: Array, mean: Field, weights: Sequence[Weights], box: Box, pitch: int
) -> Field:
    """I in [0, 1] of the rectangle ``box`` (patch units) of a patch whose pixels are ``pitch``
    units apart: the greatest that any of ``weights`` gives. ``mean`` is the neighbourhood's
    brightness on the small patch."""
    rows = [(w.magenta, w.black, w.brightness, w.hue, w.constant) for w in weights]
    return np.asarray(
        _transform(
            patch,
            gains.astype(np.float32),
            mean,
            np.array(rows, dtype=np.float32),
            window(box, pitch),
            (COARSE // pitch).bit_length() - 1,
        )
    )


def channels(patch: Picture, gains: Array, mean: Field, box: Box, pitch: int) -> Array:
    """(H, W, 4) M, K, V and G(H) of the rectangle ``box``, in plain NumPy: for training, and to
    hold the kernel to."""
    left, top, right, bottom = window(box, pitch)
    step = COARSE // pitch
    scaled = patch[top:bottom, left:right] * gains
    bright = np.maximum(scaled.max(axis=2), 0.25)
    pink = ((bright - scaled[..., 1]) / bright - MAGENTA_SKIN) / 0.15
    near = mean[np.arange(top, bottom)[:, None] // step, np.arange(left, right) // step]
    shown, around = np.log(_level(bright)), np.log(_level(near))
    return np.stack(
        [
            np.clip(pink, -2.0, 2.0),
            np.clip(around - shown, -0.6, 1.5),
            np.clip(shown - np.log(USUAL_SKIN[0]), -1.5, 0.6),
            hue_response(_hue(scaled)),
        ],
        axis=-1,
    )


def _level(value: Field) -> Array:
    return np.asarray(np.maximum(np.minimum(value, _BRIGHTEST), 0.25), dtype=float)


def _hue(colour: Array) -> Array:
    """(...) degrees, -180..180, of colours (..., 3)."""
    r, g, b = np.moveaxis(colour, -1, 0)
    most = np.maximum(colour.max(axis=-1), 0.25)
    spread = most - colour.min(axis=-1) + 1e-3
    return np.asarray(
        np.where(
            r >= most,
            60.0 * (g - b) / spread,
            np.where(g >= most, 60.0 * (b - r) / spread + 120.0, 60.0 * (r - g) / spread - 120.0),
        )
    )


@cache
def window(box: Box, pitch: int = 1) -> Box:
    """Columns and rows that a rectangle in patch units covers on a patch whose pixels are
    ``pitch`` units apart."""
    x, y = ORIGIN.astype(int).tolist()
    left, top, right, bottom = box
    return (
        max(left + x, 0) // pitch,
        max(top + y, 0) // pitch,
        min(right + x, WIDTH) // pitch,
        min(bottom + y, HEIGHT) // pitch,
    )


@njit(cache=True, nogil=True, fastmath=True)
def _pixel(patch: Picture, gains: Field, y: int, x: int) -> tuple[Any, Any, Any]:
    """Red, green and blue of one pixel under the skin's own light."""
    return patch[y, x, 0] * gains[0], patch[y, x, 1] * gains[1], patch[y, x, 2] * gains[2]


@njit(cache=True, nogil=True, fastmath=True)
def _brightness(patch: Picture, gains: Field) -> Field:
    rows, columns, _ = patch.shape
    value = np.empty(rows * columns, dtype=np.float32)
    # Flat, so that the compiler knows how far pixels are apart: it then does several at once.
    flat = patch.reshape(-1)
    for n in range(rows * columns):
        r, g, b = flat[3 * n] * gains[0], flat[3 * n + 1] * gains[1], flat[3 * n + 2] * gains[2]
        value[n] = min(max(r, g, b), np.float32(_BRIGHTEST))
    return value.reshape(rows, columns)


@njit(cache=True, nogil=True, fastmath=True)
def _transform(
    patch: Picture, gains: Field, mean: Field, weights: Field, box: Box, halvings: int
) -> Field:
    """``mean`` has its pixels 2^``halvings`` pixels apart: divided by a number that is not known
    beforehand, their places would take as long as all the rest."""
    left, top, right, bottom = box
    result = np.empty((bottom - top, right - left), dtype=np.float32)
    level = np.float32(_LEVELS / _BRIGHTEST)
    pink = tinted = False
    for i in range(len(weights)):
        pink = pink or weights[i, 0] != 0.0
        tinted = tinted or weights[i, 3] != 0.0
    magenta = hued = np.float32(0.0)
    for y in range(top, bottom):
        for x in range(left, right):
            r, g, b = _pixel(patch, gains, y, x)
            v = max(r, g, b, np.float32(0.25))
            if pink:
                magenta = ((v - g) / v - np.float32(MAGENTA_SKIN)) / np.float32(0.15)
                magenta = min(max(magenta, np.float32(-2.0)), np.float32(2.0))
            if tinted:
                hue = _hue_of(r, g, b, v)
                hued = _HUES[int((hue + np.float32(180.0)) * np.float32(_LEVELS / 360.0))]
            bright = _LOG[int(min(v, np.float32(_BRIGHTEST)) * level)]
            black = _LOG[int(mean[y >> halvings, x >> halvings] * level)] - bright
            black = min(max(black, np.float32(-0.6)), np.float32(1.5))
            bright = min(max(bright, np.float32(-1.5)), np.float32(0.6))
            intensity = np.float32(-1.0)
            for i in range(len(weights)):
                intensity = max(
                    intensity,
                    weights[i, 0] * magenta
                    + weights[i, 1] * black
                    + weights[i, 2] * bright
                    + weights[i, 3] * hued
                    + weights[i, 4],
                )
            place = (intensity + np.float32(1.0)) * np.float32(_LEVELS / 3.0)
            result[y - top, x - left] = _CONTRASTS[int(min(place, np.float32(_LEVELS)))]
    return result


@njit(cache=True, nogil=True, fastmath=True)
def _hue_of(r: float, g: float, b: float, most: float) -> Any:
    """Degrees, -180..180."""
    spread = most - min(r, g, b) + np.float32(1e-3)
    if r >= most:
        return np.float32(60.0) * (g - b) / spread
    if g >= most:
        return np.float32(60.0) * (b - r) / spread + np.float32(120.0)
    return np.float32(60.0) * (r - g) / spread - np.float32(120.0)
