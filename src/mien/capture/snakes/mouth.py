"""The mouth's opening inside the lips: what is dark, what is teeth, what is tongue."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.colour.skin import USUAL_SKIN
from mien.capture.snakes.colour.transform import MAGENTA_SKIN, Field
from mien.capture.snakes.curves.lens import (
    LOWER,
    UPPER,
    fit_lens,
    height,
    lower_curve,
    outline,
    upper_curve,
)
from mien.numeric import bezier

Array = NDArray[np.float64]
Mask = NDArray[np.uint8]

_DARK = 0.38
"""ln(V of the lips / V) from which a pixel is dark."""
_PALE = 0.65
"""Share of the skin's magenta that a tooth has at most: lips have more than skin, teeth less."""
_BRIGHT = 0.55
"""Share of the lips' brightness that a tooth has at least."""
_FEWEST = 30
"""Pixels of an opening."""
_SLIT = 3.0
"""Patch units of height below which a mouth is shut and one curve serves both lips."""
_WIDE = 0.5
"""Share of the lips' width that an opening has at least: a dark spot in shaded lips has less."""
_RING = 0.14
"""Depth of the lips' own colour inside their outline, in heights."""
_STRIP, _HAIRY = 6.0, 0.2
"""Patch units above the lips, and ln(V of the skin / V) from which hair grows there."""
_PINKEST, _LEAST_PINK, _LIT, _BLUE = 0.85, 1.12, 0.85, 0.88
"""A tongue has at most this share of the magenta of the reddest quarter of the mouth and at least
that of the skin's, this share of the lips' brightness, and this much blue for its green: skin
and lit lips have less."""
_LIP = 0.3
"""Share of the mouth's height that its lower lip takes."""
_TONGUE = (0.04, 0.12)
"""Shares of the mouth that tongue takes where it is in and where it is plainly out."""
_MARGIN = np.ones((3, 3), np.uint8)
_SPECK = np.ones((2, 2), np.uint8)


@dataclass(frozen=True, slots=True)
class LipColour:
    """What the lips' own skin looks like."""

    value: float
    magenta: float


@dataclass(frozen=True, slots=True)
class Opening:
    """What shows between the lips."""

    lens: Array
    """(6, 2)"""
    teeth: float
    """Share of the lips' outline that is teeth."""
    tongue: float
    """How far the tongue is out, 0..1."""


def lip_colour(lens: Array, value: Field, magenta: Field, corner: Array) -> LipColour:
    """Medians on a ring inside the outline; ``value`` and ``magenta`` are the lips' rectangle."""
    inset = _RING * height(lens) * np.array([0.0, 1.0])
    ring = np.concatenate(
        [upper_curve(lens, 15)[3:-3] + inset, lower_curve(lens, 15)[3:-3] - inset]
    )
    column, row = np.round(ring - corner).astype(int).T
    row, column = np.clip(row, 0, value.shape[0] - 1), np.clip(column, 0, value.shape[1] - 1)
    bright, pink = np.median(value[row, column]), np.median(magenta[row, column])
    return LipColour(float(max(bright, 1.0)), float(max(pink, 0.5 * MAGENTA_SKIN)))


def inside_masks(value: Field, magenta: Field, lips: LipColour) -> tuple[Mask, Mask]:
    """Dark pixels and teeth in the lips' rectangle, 0 or 1."""
    dark = value < lips.value * np.exp(-_DARK)
    teeth = (magenta < _PALE * MAGENTA_SKIN) & (value > _BRIGHT * lips.value)
    return dark.astype(np.uint8), teeth.astype(np.uint8)


def tongue_out(
    lips: Array, mouth: LipColour, value: Field, magenta: Field, blue: Field, corner: Array
) -> float:
    """How far the tongue is out, 0..1: pale and pink, under dark and above no teeth, and not where
    the lower lip is; ``blue`` is B / G."""
    dark, teeth = inside_masks(value, magenta, mouth)
    within = np.asarray(cv2.erode(filled(lips, corner, value.shape), _MARGIN), np.uint8)
    if not (dark & within).any():
        return 0.0
    above_lip = np.zeros_like(within)
    rise = min(max(round(_LIP * float(height(lips))), 0), len(within))
    above_lip[: len(within) - rise] = within[rise:]
    reddest = float(np.quantile(magenta[within > 0], 0.75))
    pink = (magenta > _LEAST_PINK * MAGENTA_SKIN) & (magenta < _PINKEST * reddest)
    pink &= (value > _LIT * mouth.value) & (blue > _BLUE)
    pale = cv2.morphologyEx(pink & within & above_lip, cv2.MORPH_OPEN, _MARGIN)
    black = cv2.morphologyEx(dark & within, cv2.MORPH_OPEN, _SPECK)
    under = np.maximum.accumulate(black, axis=0)
    over_teeth = np.maximum.accumulate((teeth & within)[::-1], axis=0)[::-1]
    share = float((pale & under & (1 - over_teeth)).sum()) / float(within.sum())
    return float(np.clip((share - _TONGUE[0]) / (_TONGUE[1] - _TONGUE[0]), 0.0, 1.0))


def moustache(lips: Array, value: Field, corner: Array) -> bool:
    """Whether what is above the lips (6, 2) is darker than skin: dark is no sign then."""
    strip = upper_curve(lips, 15)[3:-3] - np.array([0.0, _STRIP])
    column, row = np.round(strip - corner).astype(int).T
    row, column = np.clip(row, 0, value.shape[0] - 1), np.clip(column, 0, value.shape[1] - 1)
    return bool(np.median(value[row, column]) < USUAL_SKIN.max() * np.exp(-_HAIRY))


def filled(lens: Array, corner: Array, shape: tuple[int, int]) -> Mask:
    """The lens as a mask of its rectangle."""
    mask = np.zeros(shape, np.uint8)
    cv2.fillPoly(mask, [np.round(outline(lens) - corner).astype(np.int32)], 1)
    return mask


def find_opening(
    lips: Array, value: Field, dark: Mask, teeth: Mask, tongue: float, corner: Array
) -> Opening:
    """The inner lips inside the outer ones ``lips`` (6, 2)."""
    within: Mask = np.asarray(cv2.erode(filled(lips, corner, value.shape), _MARGIN), np.uint8)
    seen = cv2.morphologyEx((dark | teeth) & within, cv2.MORPH_OPEN, _MARGIN)
    share = float((teeth & within).sum()) / max(float(within.sum()), 1.0)
    rows, columns = np.nonzero(seen)
    if len(rows) >= _FEWEST:
        hull = cv2.convexHull(np.stack([columns, rows], 1).astype(np.int32))[:, 0].astype(float)
        lens = _hull_lens(hull) + corner
        wide = float(np.ptp(hull[:, 0])) > _WIDE * float(lips[1, 0] - lips[0, 0])
        if wide and height(lens) >= _SLIT:
            return Opening(lens, share, tongue)
    return Opening(_slit(lips, value, corner), share, tongue)


def _hull_lens(hull: Array) -> Array:
    """(6, 2) the lens on a convex polygon (N, 2)."""
    first, last = int(hull[:, 0].argmin()), int(hull[:, 0].argmax())
    one = np.roll(hull, -first, axis=0)[: (last - first) % len(hull) + 1]
    two = np.roll(hull, -last, axis=0)[: (first - last) % len(hull) + 1][::-1]
    upper, lower = (one, two) if one[:, 1].mean() < two[:, 1].mean() else (two, one)
    return fit_lens(_dense(upper), _dense(lower))


def _dense(edge: Array) -> Array:
    """(17, 2) places evenly along x on a polyline."""
    x = np.linspace(edge[0, 0], edge[-1, 0], 17)
    return np.stack([x, np.interp(x, edge[:, 0], edge[:, 1])], axis=1)


def _slit(lips: Array, value: Field, corner: Array) -> Array:
    """(6, 2) one curve along the darkest places between shut lips."""
    upper, lower = upper_curve(lips, 25)[2:-2], lower_curve(lips, 25)[2:-2]
    share = np.linspace(0.25, 0.75, 21)[:, None, None]
    places = upper + share * (lower - upper) - corner
    column, row = np.round(places).astype(int).transpose(2, 0, 1)
    row, column = np.clip(row, 0, value.shape[0] - 1), np.clip(column, 0, value.shape[1] - 1)
    seen = value[row, column]
    away = ((share[..., 0] - 0.5) / 0.25) ** 2
    best = (seen + 0.1 * seen.mean() * away).argmin(axis=0)
    darkest = places[best, np.arange(places.shape[1])] + corner
    control = bezier.fit(np.concatenate([lips[:1], darkest, lips[1:2]]))
    lens = np.empty((6, 2))
    lens[UPPER], lens[LOWER] = control, control
    return lens
