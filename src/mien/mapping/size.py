"""Bringing the motion of one face to the size of another by FAPU."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import astuple

import numpy as np
from numpy.typing import NDArray

from mien.vocabulary.fapu import measure
from mien.vocabulary.fdp import feature_points

Array = NDArray[np.float64]

_LIDS = frozenset({"3.1", "3.2", "3.3", "3.4"})
_MOUTH = frozenset({2, 6, 8})
"""Groups of the chin and inner lips, the tongue, the outer lips."""


def scales(points: Sequence[str], target: Array, source: Array) -> Array:
    """(P, 3) factors that bring motion of a face with neutral ``source`` (P, 3) to the size of
    one with neutral ``target`` (P, 3), both at FDP ``points`` (P).

    Mouth and chin go by mouth width; lid margins by lid opening, so that shut is shut on
    either; all else by the distance of the pupils across and eye to nose up and forwards. (Each
    FAP's own unit did no better, one length for the whole face worse to look at.) Where a face
    lacks the points for a length, its overall size stands in.
    """
    ratio = [
        b / a
        for a, b in zip(
            astuple(measure(points, source)), astuple(measure(points, target)), strict=True
        )
    ]
    overall = _spread(target) / _spread(source)
    iris, eyes, nose, _, mouth = (overall if math.isnan(r) else r for r in ratio)
    known = feature_points()
    factors = np.empty((len(points), 3))
    for i, fdp in enumerate(points):
        if fdp in _LIDS:
            factors[i] = iris
        elif known[fdp].group in _MOUTH:
            factors[i] = mouth
        else:
            factors[i] = eyes, nose, nose
    return factors


def _spread(places: Array) -> float:
    return float(np.sqrt(((places - places.mean(axis=0)) ** 2).sum(axis=1).mean()))
