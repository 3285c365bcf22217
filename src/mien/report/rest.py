"""What a character does while the performer does nothing: it should do nothing."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.face.targets import targets
from mien.performance.curves import Curves
from mien.performance.performance import Performance

Array = NDArray[np.float64]

_SECONDS = 0.5


@dataclass(frozen=True, slots=True)
class Rest:
    """The quietest half second of a take, G frames of it."""

    time: Array
    """(G,) seconds."""
    performer: Array
    """(G,) mm, root mean square over the feature points, off their straight course through this
    half second: a slow drift is no tremble."""
    character: Array
    """(G,) the same of the character's own points."""

    @property
    def tremble(self) -> tuple[float, float]:
        """Root mean square over time, mm: the performer's as measured, and the character's."""
        return _rms(self.performer), _rms(self.character)


def rest(performance: Performance, character: Character, curves: Curves, motion: Array) -> Rest:
    """How still ``character`` is while ``motion`` (F,) is least."""
    window = _quietest(performance, motion)
    points = character.face.points
    fields = points.at(targets(character, curves.names).displacements.astype(float))
    acted = np.tensordot(curves.weights[window], fields, axes=1)
    time = performance.time[window]
    return Rest(time, _away(performance.motion[window], time), _away(acted, time))


def _quietest(performance: Performance, motion: Array) -> slice:
    count = len(motion)
    pace = float(np.median(np.diff(performance.time))) if count > 1 else _SECONDS
    length = min(count, max(2, round(_SECONDS / max(pace, 1e-3))))
    effort = np.where(performance.lost, np.inf, motion)
    sums = np.lib.stride_tricks.sliding_window_view(effort, length).sum(axis=1)
    first = int(np.argmin(sums))
    return slice(first, first + length)


def _away(motion: Array, time: Array) -> Array:
    """(G,) of motion (G, P, 3) at ``time`` (G,)."""
    if not motion.size:
        return np.zeros(len(motion))
    since = (time - time.mean())[:, None, None]
    slope = (since * motion).sum(axis=0) / max(float((since**2).sum()), 1e-12)
    away = motion - motion.mean(axis=0) - since * slope
    return np.asarray(np.sqrt((away**2).sum(axis=-1).mean(axis=1)))


def _rms(values: Array) -> float:
    return float(np.sqrt((values**2).mean()))
