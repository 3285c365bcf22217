"""How much of a performance a character's key models reach."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.performance.curves import Curves
from mien.performance.performance import Performance

Array = NDArray[np.float64]
Frames = NDArray[np.bool_]

_LARGE = 0.5
"""Share of a frame's motion that has to be missing for the frame to count as not reached ..."""
_CERTAIN = 2.0
"""... and standard errors of what is missing: below that it may be the capture's own noise."""


@dataclass(frozen=True, slots=True)
class Reach:
    """F frames of motion, and of what was not expressed of it."""

    motion: Array
    """(F,) mm, root mean square over the feature points, along what was seen."""
    residual: Array
    """(F,) mm of it that no key model expressed."""
    unreached: Frames
    """(F,) frames of which most is missing, and more than was measured with certainty."""

    @property
    def missing(self) -> float:
        """Share of all motion that was not expressed, 0..1; 0 where nothing moved. In a take that
        is all noise a character may well stray farther than its performer, which is 1 too."""
        all_of_it = float((self.motion**2).sum())
        share = np.sqrt((self.residual**2).sum() / all_of_it) if all_of_it else 0.0
        return float(min(share, 1.0))


def reach(performance: Performance, curves: Curves) -> Reach:
    """What of ``performance`` the ``curves`` express, frame by frame. Weights that passed as they
    were have no motion and no residual: nothing is missing of them."""
    motion = np.where(performance.lost, 0.0, _motion(performance))
    residual = np.where(performance.lost, 0.0, curves.residual)
    unreached = (residual > _LARGE * motion) & (residual > _CERTAIN * _noise(performance))
    return Reach(motion, residual, unreached)


def telling(performance: Performance, count: int) -> list[int]:
    """``count`` frames that show what happens in a take: of as many equal parts, each one's frame
    with the most motion. Fewer where the face was lost or the take is shorter."""
    strength = np.where(performance.lost, -1.0, _strength(performance))
    parts = np.array_split(np.arange(len(strength)), count)
    chosen = [int(part[np.argmax(strength[part])]) for part in parts if len(part)]
    return [frame for frame in chosen if strength[frame] >= 0.0]


def spans(frames: Frames, time: Array) -> list[tuple[float, float]]:
    """Seconds (first, last) of each run of ``frames`` (F,)."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], frames, [False]]).astype(int)))
    return [
        (float(time[first]), float(time[last - 1])) for first, last in edges.reshape(-1, 2).tolist()
    ]


def _strength(performance: Performance) -> Array:
    if performance.points:
        return _motion(performance)
    return np.asarray(np.abs(performance.shapes).sum(axis=1))


def _motion(performance: Performance) -> Array:
    """(F,) mm."""
    if not performance.points:
        return np.zeros(len(performance))
    along = np.einsum("fpi,fi->fp", performance.motion, performance.unseen)
    square = (performance.motion**2).sum(axis=-1) - along**2
    return np.asarray(np.sqrt(square.clip(0.0).mean(axis=1)))


def _noise(performance: Performance) -> float:
    """mm, standard error of ``_motion``; 0 where there is none."""
    known = performance.sigma[np.isfinite(performance.sigma).all(axis=1)]
    sight = 1.0 - (performance.unseen**2).mean(axis=0)
    return float(np.sqrt((known**2 @ sight).mean())) if len(known) else 0.0
