"""A performance as the 52 weights of ARKit: what phones stream and most rigs speak."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.mapping.joint import JointMapper
from mien.performance.performance import Performance
from mien.vocabulary.arkit import SCALARS, names

Array = NDArray[np.float64]

_LOOK = np.radians(35.0)
"""Gaze angle at which an eyeLook shape is 1."""
_APART = ("eyeBlink", "eyeLook")
"""Set from lids and gaze, which are measured apart from the skin's motion."""
_UNSEEN = frozenset(("tongueOut", "mouthClose"))
"""No feature point tells of the tongue, and mouthClose only means something against jawOpen."""


def arkit_weights(performance: Performance, generic: Character) -> Array:
    """(F, 52) weights 0..1 in arkit52 order; as they came where the performance speaks ARKit.

    ``generic`` is the generic face, which has all 52 as key models: they are mapped like any
    character's, jointly and under bounds.
    """
    if performance.vocabulary == "arkit":
        return performance.shapes
    return ArkitMapper(generic, performance)(performance)


class ArkitMapper:
    """ARKit's weights of one performer, frame by frame or many at once."""

    def __init__(self, generic: Character, header: Performance) -> None:
        """``header`` is any performance of the performer. Raises InputError where it shows too
        little of a face."""
        self._spoken = names()
        driven = tuple(n for n in self._spoken if n not in _UNSEEN and not n.startswith(_APART))
        self._columns = [self._spoken.index(name) for name in driven]
        self._mapper = JointMapper(replace(generic, examples=driven), header)

    def __call__(self, performance: Performance) -> Array:
        """(F, 52) weights 0..1 in arkit52 order."""
        weights = np.zeros((len(performance), len(self._spoken)))
        weights[:, self._columns] = self._mapper.key_weights(performance)
        for eye, (side, inward) in enumerate((("Left", -1.0), ("Right", 1.0))):
            yaw, pitch = np.moveaxis(performance.gaze[:, eye] / _LOOK, -1, 0)
            looks = {"In": inward * yaw, "Out": -inward * yaw, "Up": pitch, "Down": -pitch}
            for way, level in looks.items():
                weights[:, self._spoken.index(f"eyeLook{way}{side}")] = level
        for scalar, word in SCALARS.items():
            if scalar in performance.scalars:
                column = weights[:, self._spoken.index(word)]
                np.fmax(column, performance.scalars[scalar], out=column)
        return np.clip(weights, 0.0, 1.0)
