"""Individual retargeting, the open question of [Z]: a performer's range becomes the character's.

A range is how far each feature point goes along each axis when its owner acts: of a performer,
over a take or a calibration; of a character, over its key models, brought to the performer's size.
What one moves by is then compared in parts of what one can, so that the small smile of somebody
whose mouth moves little is a full smile of the character.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.mapping.examples import Examples
from mien.performance.performance import Performance

Array = NDArray[np.float64]

_MOST = 98.0
"""Percentile of motion that counts as the furthest: one bad frame must not."""
_SEEN = 1.0
"""Standard errors at which a range is half believed."""
_LIMITS = (0.125, 8.0)


@dataclass(frozen=True, slots=True, eq=False)
class Ranges:
    """How far a performer's feature points go."""

    points: tuple[str, ...]
    reach: Array
    """(P, 3) mm; NaN where it was not measured."""
    sigma: Array
    """(P, 3) mm, standard error of the motion it was read from."""


def measure_ranges(performance: Performance) -> Ranges:
    """The range shown in a take (or a calibration)."""
    seen = ~performance.lost
    motion = np.abs(performance.motion[seen])
    reach = (
        np.percentile(motion, _MOST, axis=0) if len(motion) else np.full(motion.shape[1:], np.nan)
    )
    # Along the line of sight nothing was measured.
    blind = np.abs(performance.unseen[seen]).mean(axis=0) > 0.5 if len(motion) else np.zeros(3)
    reach = np.where(blind, np.nan, reach)
    return Ranges(performance.points, reach, performance.sigma)


def range_gains(ranges: Ranges | None, examples: Examples) -> Array:
    """(P, 3) by which motion at the points of ``examples`` is multiplied; 1 without ranges.

    Points that are each other's mirror image have one gain, or a face would become lopsided; so
    have the points of a feature along an axis, by their common range.
    """
    gains = np.ones((len(examples.points), 3))
    if ranges is None:
        return gains
    row = {fdp: i for i, fdp in enumerate(ranges.points)}
    own = np.abs(examples.keys).max(axis=0)
    for group in sorted({_feature(fdp) for fdp in examples.points}):
        here = [i for i, fdp in enumerate(examples.points) if _feature(fdp) == group and fdp in row]
        if not here:
            continue
        there = [row[examples.points[i]] for i in here]
        for axis in range(3):
            reach = _norm(ranges.reach[there, axis])
            noise = _norm(np.where(np.isfinite(s := ranges.sigma[there, axis]), s, np.nan))
            if not np.isfinite(reach) or not np.isfinite(noise):
                continue
            wanted = _norm(own[here, axis])
            belief = reach**4 / (reach**4 + (_SEEN * noise) ** 4)
            gains[here, axis] = np.clip(wanted / max(reach, 1e-9), *_LIMITS) ** belief
    return gains


def _feature(fdp: str) -> str:
    """The feature a point belongs to: brows, upper lids, lower lids, cheeks, jaw, lips, nose."""
    group, _, index = fdp.partition(".")
    if group == "2":
        return "jaw" if int(index) in (1, 10, 11, 12, 13, 14) else "lips"
    if group == "3":
        return "upper lids" if int(index) in (1, 2, 13, 14) else "lower lids"
    return {"4": "brows", "5": "cheeks", "8": "lips", "9": "nose"}.get(group, group)


def _norm(values: Array) -> float:
    """Root mean square of what is known; NaN where nothing is."""
    known = values[np.isfinite(values)]
    return float(np.sqrt((known**2).mean())) if len(known) else float("nan")
