"""What drives key models beside the motion of feature points: a gaze, where eyes are painted on,
and what a performance tells outright, as that the tongue is out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.performance.curves import Curves
from mien.performance.performance import Performance
from mien.vocabulary.arkit import SCALARS

Array = NDArray[np.float64]

_FULL = np.radians(35.0)
"""Gaze angle at which a key model that looks to a side is at 1."""
_OUTRIGHT = ("tongue_out", "cheek_puff")
"""Scalars of a performance that no feature point shows and no lid."""


def beside(curves: Curves, performance: Performance, character: Character) -> Curves:
    """``curves``, mapped from ``performance`` for ``character``, with those key models set."""
    levels = _looks(curves.gaze, character.looks) | _told(performance, character)
    if not levels:
        return curves
    names = (*curves.names, *(key for key in levels if key not in curves.names))
    weights = np.zeros((len(curves), len(names)))
    weights[:, : len(curves.names)] = curves.weights
    for key, level in levels.items():
        column = weights[:, names.index(key)]
        np.maximum(column, level, out=column)
    return replace(curves, names=names, weights=weights)


def driven_beside(character: Character) -> tuple[str, ...]:
    """Key models of ``character`` that ``beside`` may set, whoever performs."""
    told = (key for scalar in _OUTRIGHT for key in _answering(scalar, character))
    return tuple(dict.fromkeys((*character.looks.values(), *told)))


def _looks(gaze: Array, looks: Mapping[str, str]) -> dict[str, Array]:
    """(F,) of each key model in ``looks`` ("left", "right", "up", "down", the subject's), from
    the mean gaze of both eyes."""
    if not looks:
        return {}
    yaw, pitch = np.moveaxis(gaze.mean(axis=1) / _FULL, -1, 0)
    levels = {"left": yaw, "right": -yaw, "up": pitch, "down": -pitch}
    return {key: np.clip(levels[way], 0.0, 1.0) for way, key in looks.items()}


def _told(performance: Performance, character: Character) -> dict[str, Array]:
    """(F,) of each key model that answers to a scalar of ``performance``."""
    return {
        key: np.clip(np.nan_to_num(performance.scalars[scalar]), 0.0, 1.0)
        for scalar in _OUTRIGHT
        if scalar in performance.scalars
        for key in _answering(scalar, character)
    }


def _answering(scalar: str, character: Character) -> tuple[str, ...]:
    """Key models that answer to a scalar."""
    if scalar in character.keys.names:
        return (scalar,)
    return character.speaks.get("arkit", {}).get(SCALARS[scalar], ())
