"""Smoothing curves, a step of its own that can be left out, and what to do when nobody is seen."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.numeric.one_euro import Memory, OneEuro, filter_both_ways, filter_forward
from mien.numeric.rotation import from_vector, to_vector
from mien.performance.curves import Curves

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Smoothing:
    """How each kind of curve is filtered."""

    weights: OneEuro
    rotation: OneEuro
    """Radians."""
    translation: OneEuro
    """Millimetres."""
    gaze: OneEuro
    """Radians."""


LIVE = Smoothing(
    weights=OneEuro(1.0, 5.0, 2.0),
    rotation=OneEuro(1.0, 10.0),
    translation=OneEuro(1.0, 0.05),
    gaze=OneEuro(1.0, 5.0),
)
"""Causal: a blink keeps nine tenths of its peak at 30 frames a second."""
OFFLINE = Smoothing(
    weights=OneEuro(1.0, 15.0, 3.0),
    rotation=OneEuro(1.0, 10.0, 3.0),
    translation=OneEuro(1.0, 0.05, 3.0),
    gaze=OneEuro(1.0, 5.0, 3.0),
)
"""Run both ways, which smooths twice: the slope is followed faster, or blinks would be lost."""

_HOLD = 0.25
"""Seconds for which a face that is lost keeps its last look: a hand passes, a frame fails."""
_LEAVE = 0.8
"""Seconds in which it then eases to rest."""
_RETURN = 0.3
"""Seconds in which it eases back when the performer is seen again."""


class Smoother:
    """Causal smoothing with memory: frames come in one at a time or in runs."""

    def __init__(self, smoothing: Smoothing = LIVE) -> None:
        self._smoothing = smoothing
        self._memory: dict[str, Memory] = {}
        self._presence: _Presence | None = None

    def __call__(self, curves: Curves) -> Curves:
        """The next frames, smoothed and eased to rest where the performer is lost."""
        if not len(curves):
            return curves
        filtered = {}
        for kind, signal in _signals(curves).items():
            setting = getattr(self._smoothing, kind)
            filtered[kind], self._memory[kind] = filter_forward(
                signal, curves.time, setting, self._memory.get(kind)
            )
        share, self._presence = _presence(curves.time, curves.lost, self._presence)
        return _ease(_assemble(curves, filtered), share)


def smooth(curves: Curves, smoothing: Smoothing = OFFLINE) -> Curves:
    """A whole take smoothed without lag, and eased to rest where the performer is lost."""
    if not len(curves):
        return curves
    filtered = {
        kind: filter_both_ways(signal, curves.time, getattr(smoothing, kind))
        for kind, signal in _signals(curves).items()
    }
    share, _ = _presence(curves.time, curves.lost, None)
    return _ease(_assemble(curves, filtered), share)


def _signals(curves: Curves) -> dict[str, Array]:
    """(F, G, D) each, named as in Smoothing. No head turns half round, so that rotation vectors
    are as good as any."""
    return {
        "weights": curves.weights[..., None],
        "rotation": to_vector(curves.rotation)[:, None],
        "translation": curves.translation[:, None],
        "gaze": curves.gaze,
    }


def _assemble(curves: Curves, filtered: dict[str, Array]) -> Curves:
    return replace(
        curves,
        weights=filtered["weights"][..., 0],
        rotation=from_vector(filtered["rotation"][:, 0]),
        translation=filtered["translation"][:, 0],
        gaze=filtered["gaze"],
    )


@dataclass(frozen=True, slots=True)
class _Presence:
    time: float
    lost_for: float
    level: float


def _presence(
    time: Array, lost: NDArray[np.bool_], before: _Presence | None
) -> tuple[Array, _Presence]:
    """(F,) share of the performer in what is shown: 1 while seen, smoothly 0 when lost for long."""
    state = before or _Presence(float(time[0]), 0.0, 0.0 if lost[0] else 1.0)
    shares = np.empty(len(time))
    for i, (now, gone) in enumerate(zip(time.tolist(), lost.tolist(), strict=True)):
        step = max(now - state.time, 0.0)
        lost_for = state.lost_for + step if gone else 0.0
        if not gone:
            level = min(state.level + step / _RETURN, 1.0)
        elif lost_for > _HOLD:
            level = max(state.level - step / _LEAVE, 0.0)
        else:
            level = state.level
        state = _Presence(now, lost_for, level)
        shares[i] = level * level * (3.0 - 2.0 * level)
    return shares, state


def _ease(curves: Curves, share: Array) -> Curves:
    """``curves`` drawn to rest where ``share`` (F,) is below 1."""
    if (share == 1.0).all():
        return curves
    return replace(
        curves,
        weights=curves.weights * share[:, None],
        rotation=from_vector(to_vector(curves.rotation) * share[:, None]),
        translation=curves.translation * share[:, None],
        gaze=curves.gaze * share[:, None, None],
    )
