"""What the person at the desk does to single weights: louder, silent, or held."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from mien.live.studio.messages import Adjust
from mien.performance.curves import Curves


@dataclass(slots=True)
class Desk:
    """The adjustments of all characters."""

    _held: dict[tuple[str, str], Adjust] = field(default_factory=dict)

    def set(self, adjust: Adjust) -> None:
        """From now on."""
        key = (adjust.character, adjust.target)
        if adjust.gain == 1.0 and not adjust.muted and adjust.pinned is None:
            self._held.pop(key, None)
        else:
            self._held[key] = adjust

    def pinned(self, character: str) -> dict[str, float]:
        """What is pinned of a character, above 0."""
        return {
            target: adjust.pinned
            for (name, target), adjust in self._held.items()
            if name == character and adjust.pinned
        }

    def __call__(self, curves: Mapping[str, Curves]) -> dict[str, Curves]:
        """The adjusted curves of one frame, by character."""
        return {name: self._adjusted(name, each) for name, each in curves.items()}

    def _adjusted(self, character: str, curves: Curves) -> Curves:
        mine = {
            target: adjust for (name, target), adjust in self._held.items() if name == character
        }
        if not mine:
            return curves
        weights = curves.weights.copy()
        for column, target in enumerate(curves.names):
            adjust = mine.get(target)
            if adjust is None:
                continue
            weights[:, column] *= 0.0 if adjust.muted else adjust.gain
            if adjust.pinned is not None:
                weights[:, column] = adjust.pinned
        return replace(curves, weights=weights)
