"""Lips and the mouth bag at rest."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.sculpt.anatomy.cage import LIP_AROUND, LIPS, cage
from mien.sculpt.proportions import MouthShape

Array = NDArray[np.float64]

_AROUND = np.arange(LIP_AROUND)
ACROSS: Array = -np.cos(np.pi * _AROUND / 10)
"""(20,) -1 at the right corner, 1 at the left, along a lip loop."""
SIDE: Array = np.where((_AROUND > 0) & (_AROUND < 10), 1.0, np.where(_AROUND > 10, -1.0, 0.0))
"""(20,) 1 on the upper lip, -1 on the lower, 0 at the corners."""
FULL: Array = 1 - ACROSS**2
"""(20,) 1 in the middle, 0 at the corners."""
_UPPER, _LOWER = np.arange(11), -np.arange(11) % LIP_AROUND
"""Positions of either lip from the right corner to the left."""

INNER_OVERLAP = 0.10
_HEIGHT = (-INNER_OVERLAP, 0.34, 0.74, 1.0)
"""Height of the loops as parts of the lip's; the inner edges overlap because Loop's subdivision
opens the fold."""
_FORWARD = (-0.2, 0.9, 0.85, -0.1)
_BAG = (
    (3.5, 1.0, 0.98),
    (9.0, 6.0, 0.93),
    (22.0, 13.0, 0.85),
    (36.0, 15.0, 0.75),
    (46.0, 11.0, 0.55),
)
"""Of each ring of the bag: mm back, mm up and down, width."""


def lip_loops(mouth: MouthShape) -> Array:
    """(4, 20, 3) from the inner edge to the vermilion border."""
    corner = ACROSS**2
    line = mouth.height + mouth.bend * corner
    depth = mouth.corner_depth + (mouth.depth - mouth.corner_depth) * (1 - corner)
    bow = 1 + 0.22 * np.exp(-(((np.abs(ACROSS) - 0.24) / 0.15) ** 2))
    bow -= 0.10 * np.exp(-((ACROSS / 0.12) ** 2))
    upper, lower = mouth.upper * FULL**0.75 * bow, mouth.lower * FULL**0.62
    height = np.where(SIDE > 0, upper, np.where(SIDE < 0, -lower, 0.0))
    full = mouth.fullness * np.sqrt(FULL) * np.where(SIDE < 0, 1.15, 1.0)
    loops = [
        np.stack(
            [
                ACROSS * mouth.half_width * (1 + 0.05 * k),
                line + height * up + 0.11 * SIDE,
                depth + full * forward - 0.5 * k * np.abs(ACROSS) ** 6,
            ],
            axis=1,
        )
        for k, (up, forward) in enumerate(zip(_HEIGHT, _FORWARD, strict=True))
    ]
    return np.stack(loops)


def bag_loops(inner: Array) -> tuple[Array, Array]:
    """(5, 20, 3) rings behind the inner edge (20, 3) of the lips, and the closing point (3,)."""
    centre = inner.mean(axis=0)
    rings = []
    for number, (back, open_, width) in enumerate(_BAG):
        ring = inner * [width, 1, 1] - [0, 0, back]
        ring[:, 1] += SIDE * open_ * np.sqrt(FULL)
        if number >= 2:
            ring[:, 2] = 0.3 * ring[:, 2] + 0.7 * (centre[2] - back)
        rings.append(ring)
    return np.stack(rings), centre - np.array([0, 0, 50.0])


def lip_volumes(posed: Array) -> Array:
    """(..., 2) mm³ of the upper and the lower lip on a skin ``posed`` (..., V, 3): what lies
    between their skin, from the vermilion border to the first ring of the bag, and the straight
    way back."""
    rings = np.vstack([LIPS[3::-1], cage().bag[:1]])
    halves = [_tube_volume(posed[..., rings[:, lip], :]) for lip in (_UPPER, _LOWER)]
    return np.stack(halves, axis=-1)


def _tube_volume(sections: Array) -> Array:
    """(...) of the tube through ``sections`` (..., rings, along, 3), closed at its ends."""
    rings, along = sections.shape[-3:-1]
    origin = sections.mean(axis=(-3, -2), keepdims=True)
    at = sections - origin
    here, there = at[..., :-1, :], at[..., 1:, :]
    total = np.zeros(sections.shape[:-3])
    for a in range(rings):
        b = (a + 1) % rings
        total += _wedges(here[..., a, :, :], here[..., b, :, :], there[..., b, :, :])
        total += _wedges(here[..., a, :, :], there[..., b, :, :], there[..., a, :, :])
    for a in range(1, rings - 1):
        first, last = (at[..., (0, a, a + 1), end, :] for end in (0, along - 1))
        total -= _wedges(first[..., :1, :], first[..., 1:2, :], first[..., 2:, :])
        total += _wedges(last[..., :1, :], last[..., 1:2, :], last[..., 2:, :])
    return np.abs(total)


def _wedges(a: Array, b: Array, c: Array) -> Array:
    """(...) signed volume between triangles (..., N, 3) and the origin."""
    return np.asarray((a * np.cross(b, c)).sum(axis=(-2, -1)) / 6)
