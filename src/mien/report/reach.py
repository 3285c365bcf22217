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
"""Share of a frame's motion that has to be missing for the frame to count as not reached."""
_BEYOND = 2.0
"""Times the tremble of rest that has to be missing besides."""
_REST = 0.2
"""Share of the frames, those with the least motion, that tell what rest looks like."""


@dataclass(frozen=True, slots=True)
class Reach:
    """F frames of motion, and of what was not expressed of it."""

    motion: Array
    """(F,) mm, root mean square over the feature points, along what was seen."""
    residual: Array
    """(F,) mm of it that no key model expressed."""
    unreached: Frames
    """(F,) frames of which most is missing, and more than noise."""

    @property
    def missing(self) -> float:
        """Share of all motion that was not expressed, 0..1; 0 where nothing moved."""
        all_of_it = float((self.motion**2).sum())
        return float(np.sqrt((self.residual**2).sum() / all_of_it)) if all_of_it else 0.0


def reach(performance: Performance, curves: Curves) -> Reach:
    """What of ``performance`` the ``curves`` express, frame by frame. Weights that passed as they
    were have no motion and no residual: nothing is missing of them."""
    motion = np.where(performance.lost, 0.0, _motion(performance))
    residual = np.where(performance.lost, 0.0, curves.residual)
    if not len(performance.points):
        return Reach(motion, residual, np.zeros(len(motion), dtype=bool))
    quiet = motion <= np.quantile(motion, _REST)
    noise = float(np.sqrt((residual[quiet] ** 2).mean()))
    unreached = (residual > _LARGE * motion) & (residual > _BEYOND * noise)
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
