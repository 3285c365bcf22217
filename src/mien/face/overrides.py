"""What one expression takes from others: VRM's overrideBlink, overrideLookAt and overrideMouth.

A laughing face may have its eyes shut in itself; where its artist said so, a blink on top of it is
shown less ("blend") or not at all ("block"), as programs do that play VRM.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.performance.curves import Curves

Array = NDArray[np.float64]

YIELDING: Mapping[str, Collection[str]] = {
    "blink": ("blink", "blinkLeft", "blinkRight"),
    "lookAt": ("lookUp", "lookDown", "lookLeft", "lookRight"),
    "mouth": ("aa", "ih", "ou", "ee", "oh"),
}
"""Which expressions give way, by what is overridden."""
_LEAST = 1e-3
"""Of what is left of a weight, to be multiplied up again."""
_TRACE = 0.1
"""Weight up to which an expression that blocks others counts as none: the slightest would do so."""


def overridden(curves: Curves, character: Character) -> Curves:
    """``curves`` with what gives way taken back."""
    origin = character.origin
    if origin is None or not origin.overrides:
        return curves
    weights, gaze = curves.weights.copy(), curves.gaze
    words = [origin.expressions.get(key, "") for key in curves.names]
    for column, ways in enumerate(origin.overrides.get(name, {}) for name in words):
        if "block" in ways.values():
            weights[:, column] = np.maximum(weights[:, column] - _TRACE, 0.0) / (1.0 - _TRACE)
    for what, names in YIELDING.items():
        left = _left(weights, words, origin.overrides, what)
        for column, name in enumerate(words):
            if name in names:
                weights[:, column] *= left
        if what == "lookAt":
            gaze = gaze * left[:, None, None]
    return replace(curves, weights=weights, gaze=gaze)


def _left(
    weights: Array, words: list[str], overrides: Mapping[str, Mapping[str, str]], what: str
) -> Array:
    """(F,) part of its weight that ``what`` keeps."""
    left = np.ones(len(weights))
    for column, word in enumerate(words):
        way, level = overrides.get(word, {}).get(what), np.clip(weights[:, column], 0.0, 1.0)
        if way == "block":
            left = np.where(level > 0.0, 0.0, left)
        elif way == "blend":
            left = left * (1.0 - level)
    return left


def for_player(curves: Curves, character: Character) -> Curves:
    """``curves`` that were overridden as a player of VRM wants them, who overrides by himself."""
    origin = character.origin
    if origin is None or not origin.overrides:
        return curves
    weights, gaze = curves.weights.copy(), curves.gaze
    words = [origin.expressions.get(key, "") for key in curves.names]
    for what, names in YIELDING.items():
        left = np.maximum(_left(curves.weights, words, origin.overrides, what), _LEAST)
        for column, word in enumerate(words):
            if word in names:
                weights[:, column] = np.clip(weights[:, column] / left, 0.0, 1.0)
        if what == "lookAt":
            gaze = gaze / left[:, None, None]
    return replace(curves, weights=weights, gaze=gaze)
