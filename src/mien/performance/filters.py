"""Smoothing curves, a step of its own that can be left out, and what to do when nobody is seen."""

from __future__ import annotations

from collections.abc import Sequence
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
        return self.together([curves])[0]

    def together(self, cast: Sequence[Curves]) -> list[Curves]:
        """The next frames of several characters whom one performer drives; always the same ones."""
        if not cast or not len(cast[0]):
            return list(cast)
        time = cast[0].time
        filtered = {}
        for kind, signal in _signals(cast).items():
            setting = getattr(self._smoothing, kind)
            filtered[kind], self._memory[kind] = filter_forward(
                signal, time, setting, self._memory.get(kind)
            )
        share, self._presence = _presence(time, cast[0].lost, self._presence)
        return _assemble(cast, _ease(filtered, share))


def smooth(curves: Curves, smoothing: Smoothing = OFFLINE) -> Curves:
    """A whole take smoothed without lag, and eased to rest where the performer is lost."""
    if not len(curves):
        return curves
    filtered = {
        kind: filter_both_ways(signal, curves.time, getattr(smoothing, kind))
        for kind, signal in _signals([curves]).items()
    }
    share, _ = _presence(curves.time, curves.lost, None)
    return _assemble([curves], _ease(filtered, share))[0]


def _signals(cast: Sequence[Curves]) -> dict[str, Array]:
    """(F, G, D) each, named as in Smoothing, character after character. No head turns half round,
    so that rotation vectors are as good as any."""
    return {
        "weights": np.concatenate([curves.weights for curves in cast], axis=1)[..., None],
        "rotation": to_vector(np.stack([curves.rotation for curves in cast], axis=1)),
        "translation": np.stack([curves.translation for curves in cast], axis=1),
        "gaze": np.concatenate([curves.gaze for curves in cast], axis=1),
    }


def _assemble(cast: Sequence[Curves], filtered: dict[str, Array]) -> list[Curves]:
    """``cast`` with its signals replaced by ``filtered`` ones."""
    rotation, weights = from_vector(filtered["rotation"]), filtered["weights"][..., 0]
    smoothed, first = [], 0
    for number, curves in enumerate(cast):
        last = first + curves.weights.shape[1]
        smoothed.append(
            replace(
                curves,
                weights=weights[:, first:last],
                rotation=rotation[:, number],
                translation=filtered["translation"][:, number],
                gaze=filtered["gaze"][:, 2 * number : 2 * number + 2],
            )
        )
        first = last
    return smoothed


def _ease(signals: dict[str, Array], share: Array) -> dict[str, Array]:
    """``signals`` drawn to rest, which is 0 for each, where ``share`` (F,) is below 1."""
    if (share == 1.0).all():
        return signals
    return {kind: signal * share[:, None, None] for kind, signal in signals.items()}


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
