"""Where the irises are: the dark discs beside the whites of the eyes, sought for both at once.

Eyes mostly look the same way, so of two places that fit alike the pair that agrees is taken. They
may cross: disagreement costs only so much.
"""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.colour.transform import Field
from mien.capture.snakes.curves.fields import Look
from mien.capture.snakes.head.patch import COARSE, ORIGIN

Array = NDArray[np.float64]

RADIUS = 9.3
"""Patch units of an iris (11.7 mm across; pupils 63 mm apart)."""
_SIDE, _TALL, _SHARE = 1.75, 0.6, 0.5
"""How far the whites reach and how tall they are, in radii, and what they count."""
_APART, _ASIDE = 0.001, 0.0004
"""Per squared patch unit: what it costs to disagree, and to look aside."""
_CROSSED = 144.0
"""Squared patch units of disagreement beyond which it costs no more."""
_REACH, _FALL = 14, 5
"""Patch units across, and pixels of the small patch up or down, in which they are sought."""
_DARKEST = 1.2


def _disc() -> Field:
    """The pattern on the small patch: 1 in all in the disc, less where whites are."""
    radius = RADIUS / COARSE
    reach = int(np.ceil(_SIDE * radius)) + 1
    y, x = np.mgrid[-reach : reach + 1, -reach : reach + 1].astype(float)
    away = np.hypot(x, y)
    disc = np.clip(radius + 0.5 - away, 0.0, 1.0)
    whites = np.clip(_SIDE * radius + 0.5 - away, 0.0, 1.0)
    whites *= (away > radius + 1.0) & (np.abs(y) < _TALL * radius)
    pattern = disc / disc.sum() - _SHARE * whites / whites.sum()
    return np.asarray(pattern, dtype=np.float32)


_PATTERN = _disc()
_MARGIN = len(_PATTERN) // 2
_ACROSS = np.arange(-_REACH, _REACH + 1, dtype=float)
_DOWN = np.arange(-_FALL - 1, _FALL, dtype=float) * COARSE / 2.0
_AGREE = _APART * np.minimum((_ACROSS[:, None] - _ACROSS) ** 2, _CROSSED) + _ASIDE * (
    _ACROSS[:, None] ** 2 + _ACROSS**2
)


def find_irises(look: Look, eyes: Array) -> Array:
    """(2, 2) patch units of both irises between the corners of ``eyes`` (2, 6, 2)."""
    middles = eyes[:, :2].mean(axis=1)
    fits = np.stack([_fit(look, middle) for middle in middles])
    best = fits.max(axis=1)
    chosen = np.unravel_index((best[0][:, None] + best[1] - _AGREE).argmax(), _AGREE.shape)
    return np.stack(
        [
            middle + np.array([_ACROSS[column], _DOWN[fit[:, column].argmax()]])
            for middle, fit, column in zip(middles, fits, chosen, strict=True)
        ]
    )


def _fit(look: Look, middle: Array) -> Array:
    """(down, across) how well an iris fits at each place round the middle of an eye."""
    centre = (middle + ORIGIN - 0.5 * (COARSE - 1)) / COARSE
    reach = np.array([_REACH, 2 * _FALL]) / COARSE + _MARGIN + 2
    size = np.array(look.value.shape[::-1])
    left, top = np.clip(np.floor(centre - reach), 0, size - 1).astype(int)
    right, bottom = np.clip(np.ceil(centre + reach), [left + 1, top + 1], size).astype(int)
    shown = np.maximum(look.value[top:bottom, left:right], 1.0)
    around = np.maximum(look.mean[top:bottom, left:right], 1.0)
    dark = np.clip(np.log(around / shown), 0.0, _DARKEST)
    fit = cv2.filter2D(dark, -1, _PATTERN, borderType=cv2.BORDER_REPLICATE)
    x, y = np.empty((2, len(_DOWN), len(_ACROSS)), dtype=np.float32)
    x[:] = centre[0] - left + _ACROSS / COARSE
    y[:] = (centre[1] - top + _DOWN / COARSE)[:, None]
    found = cv2.remap(fit, x, y, cv2.INTER_LINEAR)
    return np.asarray(found, dtype=float)
