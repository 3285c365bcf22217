"""The mouth's opening inside the lips: what is dark and what is teeth."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.capture.snakes.colour.pigments import Pigments
from mien.capture.snakes.colour.transform import MAGENTA_SKIN, Box, Field
from mien.capture.snakes.curves import lens as lenses
from mien.capture.snakes.curves.lens import (
    LOWER,
    UPPER,
    fit_lens,
    lower_curve,
    tallness,
    upper_curve,
)
from mien.capture.snakes.head.patch import HEIGHT, ORIGIN, WIDTH
from mien.numeric import bezier

Array = NDArray[np.float64]
Mask = NDArray[np.uint8]
Bools = NDArray[np.bool_]

_DARK = 0.38
"""ln(V of the lips / V) from which a pixel is dark."""
_PALE = 0.65
"""Share of the skin's magenta that a tooth has at most: lips have more than skin, teeth less."""
_SHADED = 0.9
"""The same of teeth in the shade, or in a soft picture."""
_BRIGHT = 0.55
"""Share of the lips' brightness that a tooth has at least."""
_FEWEST = 30
"""Pixels of an opening."""
_SLIT = 3.0
"""Patch units of height below which a mouth is shut and one curve serves both lips."""
_LINE = 4.0
"""Patch units of mean thickness below which what is dark, without teeth, is the line between shut
lips; it may be bent and fill a taller box."""
_ACROSS = np.linspace(0.25, 0.75, 21)
"""Shares of the way from the upper to the lower lip at which the slit may be."""
_WIDE = 0.5
"""Share of the lips' width that an opening has at least: a dark spot in shaded lips has less."""
_RING = 0.14
"""Depth of the lips' own colour inside their outline, in heights."""
_MARGIN = np.ones((3, 3), np.uint8)
_END = np.array([WIDTH, HEIGHT])
_LAST = _END - 1


@dataclass(frozen=True, slots=True)
class LipColour:
    """What the lips' own skin looks like."""

    value: float
    magenta: float


@dataclass(frozen=True, slots=True)
class Inside:
    """The pixels of a mouth; masks (H, W) are 0 or 1."""

    lips: LipColour
    within: Mask
    """Inside the lips' outline."""
    dark: Mask
    teeth: Mask


@dataclass(frozen=True, slots=True)
class Opening:
    """What shows between the lips."""

    lens: Array
    """(6, 2)"""
    teeth: float
    """Share of the lips' outline that is teeth."""


def lip_colour(outline: Array, seen: Pigments) -> LipColour:
    """Medians on a ring inside the lips' outline (6, 2)."""
    inset = _RING * tallness(outline) * np.array([0.0, 1.0])
    ring = np.concatenate(
        [upper_curve(outline, 15)[3:-3] + inset, lower_curve(outline, 15)[3:-3] - inset]
    )
    bright = median(seen.values(seen.value, ring))
    pink = median(seen.values(seen.magenta, ring))
    return LipColour(max(bright, 1.0), max(pink, 0.5 * MAGENTA_SKIN))


def around(outline: Array) -> Box:
    """Columns and rows of the patch that hold a lens (6, 2)."""
    left, top = np.clip(np.floor(outline.min(axis=0) + ORIGIN).astype(int) - 2, 0, _LAST)
    right, bottom = np.clip(np.ceil(outline.max(axis=0) + ORIGIN).astype(int) + 3, 1, _END)
    return int(left), int(top), max(int(right), int(left) + 1), max(int(bottom), int(top) + 1)


def bright(seen: Pigments, lips: LipColour) -> Bools:
    """Pixels that are as bright as teeth are at least."""
    return seen.value > _BRIGHT * lips.value


def teeth(seen: Pigments, lips: LipColour) -> Mask:
    """Pixels that are plainly teeth, 0 or 1."""
    white = (seen.magenta < _PALE * MAGENTA_SKIN) & bright(seen, lips)
    return np.asarray(white.view(np.uint8))


def filled(outline: Array, seen: Pigments) -> Mask:
    """A lens (6, 2) as a mask."""
    mask = np.zeros(seen.value.shape, np.uint8)
    cv2.fillPoly(mask, [np.rint(seen.pixels(lenses.outline(outline))).astype(np.int32)], 1)
    return mask


def look_inside(outline: Array, seen: Pigments, lips: LipColour) -> Inside:
    """What is within the lips' ``outline`` (6, 2)."""
    dark = (seen.value < lips.value * np.exp(-_DARK)).view(np.uint8)
    within = np.asarray(cv2.erode(filled(outline, seen), _MARGIN), dtype=np.uint8)
    return Inside(lips, within, dark, teeth(seen, lips))


def find_opening(outline: Array, seen: Pigments, inside: Inside) -> Opening:
    """What shows inside the lips' ``outline`` (6, 2); ``seen`` at one patch unit a pixel."""
    within, plain = inside.within, inside.teeth & inside.within
    share = cv2.countNonZero(plain) / max(cv2.countNonZero(within), 1)
    white = plain | _shaded_teeth(seen, inside)
    shown = opened((inside.dark & within) | white, _MARGIN)
    count = cv2.countNonZero(shown)
    if count >= _FEWEST:
        upper, lower = hull_edges(shown)
        lens = fit_lens(upper, lower) + seen.corner
        width = upper[-1, 0] - upper[0, 0]
        wide = width > _WIDE * (outline[1, 0] - outline[0, 0])
        thick = count >= _LINE * width or opened(white, _MARGIN).any()
        if wide and thick and tallness(lens) >= _SLIT:
            return Opening(lens, share)
    return Opening(_slit(outline, seen), share)


def _shaded_teeth(seen: Pigments, inside: Inside) -> Mask:
    """Teeth that shade or a soft picture made nearly as pink as skin, 0 or 1: with lips, and not
    the outline's rim, all round them, for beyond it skin is as pale."""
    pale = (seen.magenta < _SHADED * MAGENTA_SKIN) & bright(seen, inside.lips)
    within = inside.within
    count, label = cv2.connectedComponents(pale.view(np.uint8) & within, connectivity=4)
    core = np.asarray(cv2.erode(within, _MARGIN, borderValue=0), dtype=np.uint8)
    enclosed = np.ones(count, dtype=np.uint8)
    enclosed[0] = 0
    enclosed[label[within > core]] = 0
    return enclosed[label]


def opened(mask: Mask, by: Mask) -> Mask:
    """``mask`` without what is smaller than ``by``."""
    return np.asarray(cv2.morphologyEx(mask, cv2.MORPH_OPEN, by), dtype=np.uint8)


@njit(cache=True, nogil=True)
def hull_edges(mask: Mask) -> tuple[Array, Array]:
    """(17, 2) each: the upper and the lower edge of the convex hull of a mask's pixels, columns
    and rows, evenly along the columns (Andrew 1979)."""
    rows, columns = mask.shape
    edges = np.empty((2, 17, 2))
    for side in range(2):
        chain_x, chain_y, size = np.empty(columns), np.empty(columns), 0
        sign = 1.0 if side == 0 else -1.0
        for x in range(columns):
            y = 0
            while y < rows and mask[y if side == 0 else rows - 1 - y, x] == 0:
                y += 1
            if y == rows:
                continue
            edge = float(y if side == 0 else rows - 1 - y)
            while (
                size > 1
                and sign
                * (
                    (chain_x[size - 1] - chain_x[size - 2]) * (edge - chain_y[size - 2])
                    - (chain_y[size - 1] - chain_y[size - 2]) * (x - chain_x[size - 2])
                )
                <= 0.0
            ):
                size -= 1
            chain_x[size], chain_y[size] = x, edge
            size += 1
        link = 0
        for n in range(17):
            x = chain_x[0] + (chain_x[size - 1] - chain_x[0]) * n / 16.0
            while link < size - 2 and chain_x[link + 1] < x:
                link += 1
            following = min(link + 1, size - 1)
            wide = max(chain_x[following] - chain_x[link], 1e-9)
            rise = chain_y[following] - chain_y[link]
            edges[side, n, 0] = x
            edges[side, n, 1] = chain_y[link] + rise * (x - chain_x[link]) / wide
    return edges[0], edges[1]


def _slit(outline: Array, seen: Pigments) -> Array:
    """(6, 2) one curve along the darkest places between shut lips."""
    upper, lower = upper_curve(outline, 25)[2:-2], lower_curve(outline, 25)[2:-2]
    places = upper + _ACROSS[:, None, None] * (lower - upper)
    dark = seen.values(seen.value, places)
    off_middle = ((_ACROSS[:, None] - 0.5) / 0.25) ** 2
    best = (dark + 0.1 * dark.mean() * off_middle).argmin(axis=0)
    darkest = places[best, np.arange(places.shape[1])]
    control = bezier.fit(np.concatenate([outline[:1], darkest, outline[1:2]]))
    lens = np.empty((6, 2))
    lens[UPPER], lens[LOWER] = control, control
    return lens


def median(values: Field) -> float:
    """Of two in the middle the upper one."""
    middle = len(values) // 2
    return float(np.partition(values, middle)[middle])
