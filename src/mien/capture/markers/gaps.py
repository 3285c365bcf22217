"""Filling gaps: what the other markers say, matched to the marker's own edges.

Splines in time know nothing of the face: over long gaps they miss by centimetres (21.9 mm mean
on the take the tests use, against 0.9). What a marker does beside what the others tell of it lasts
for a while; between the edges of a gap that is carried as a process with memory is: in a straight
line over short gaps, fading to nothing in the middle of long ones.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.capture.markers.correlation import Correlation

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_MEMORY = 0.2
"""Seconds for which a marker keeps what the others do not tell of it."""
_EDGE = 3
"""Frames beside a gap that tell what is carried into it: one alone is noisy."""


@dataclass(frozen=True, slots=True)
class Gap:
    """Frames ``first`` to ``last``, inclusive, in which a marker was not seen."""

    marker: int
    first: int
    last: int


def find_gaps(known: Mask) -> list[Gap]:
    """All gaps in ``known`` (F, M), by marker and time."""
    gaps = []
    for marker in range(known.shape[1]):
        hidden = np.concatenate([[False], ~known[:, marker], [False]]).astype(np.int8)
        begins, ends = (np.flatnonzero(np.diff(hidden) == step) for step in (1, -1))
        gaps += [Gap(marker, int(a), int(b) - 1) for a, b in zip(begins, ends, strict=True)]
    return gaps


def fill(places: Array, known: Mask, correlation: Correlation, rate: float) -> tuple[Array, Array]:
    """Places (F, M, 3) without gaps, and standard errors (F, M) in mm of what was filled (0 where
    ``known``)."""
    filled, error = correlation.predict(places, known)
    memory = max(_MEMORY * rate, 1.0)
    for gap in find_gaps(known):
        before = _edge(places, known, correlation, gap.marker, gap.first - 1, -1)
        after = _edge(places, known, correlation, gap.marker, gap.last + 1, 1)
        carried, sureness = _bridge(before, after, gap.last - gap.first + 1, memory)
        run = slice(gap.first, gap.last + 1)
        filled[run, gap.marker] += carried
        error[run, gap.marker] *= sureness
    return filled, error


def _edge(
    places: Array, known: Mask, correlation: Correlation, marker: int, frame: int, step: int
) -> Array | None:
    """(3,) what the marker does there beside what the others tell, or None beyond the take."""
    frames = np.arange(frame, frame + _EDGE * step, step)
    frames = frames[(frames >= 0) & (frames < len(places))]
    frames = frames[known[frames, marker]] if len(frames) else frames
    if not len(frames):
        return None
    others = known[frames].copy()
    others[:, marker] = False
    told, _ = correlation.predict(places[frames], others)
    return np.asarray((places[frames, marker] - told[:, marker]).mean(axis=0))


def _bridge(
    before: Array | None, after: Array | None, frames: int, memory: float
) -> tuple[Array, Array]:
    """What is carried into a gap (N, 3), and the share (N,) of the error that is left.

    An Ornstein-Uhlenbeck process pinned at the edges that are known: its mean is the edges' values
    by sinh((T - t) / memory) / sinh(T / memory) and its mirror, or exp(-t / memory) from one.
    """
    t = np.arange(1, frames + 1) / memory
    whole = (frames + 1) / memory
    none = np.zeros(3)
    if before is None and after is None:
        return np.zeros((frames, 3)), np.ones(frames)
    if before is None or after is None:
        share = np.exp(-t if after is None else -(whole - t))
        edge = before if after is None else after
        return share[:, None] * (none if edge is None else edge), np.sqrt(1.0 - share**2)
    # sinh(a) / sinh(b) for a below b, without overflow.
    ahead, behind = (
        np.exp(-(whole - a)) * -np.expm1(-2.0 * a) / -np.expm1(-2.0 * whole) for a in (whole - t, t)
    )
    left = 1.0 - ahead**2 - behind**2 - 2.0 * ahead * behind * np.exp(-whole)
    carried = ahead[:, None] * before + behind[:, None] * after
    return carried, np.sqrt(np.clip(left, 0.0, 1.0))
