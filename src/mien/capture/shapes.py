"""Weights of a known vocabulary become point motion, through the generic face's own shapes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mien.face.character import Character
from mien.performance.performance import Performance
from mien.vocabulary.arkit import SCALARS, names

_SIGMA = 0.5
"""mm; a phone's weights are smooth, and it is our own face that stands between."""


def motion_from_shapes(performance: Performance, generic: Character) -> Performance:
    """``performance`` with the motion of feature points that its ARKit weights stand for.

    The performer becomes the generic face: (F, P, 3) motion is the weighted sum of its 52 shapes
    at its feature points; what those do not show is told: lids, tongue and cheeks. Raises
    ValueError for another vocabulary.
    """
    if performance.vocabulary != "arkit":
        raise ValueError(f"no shapes are known for the vocabulary '{performance.vocabulary}'")
    face, spoken = generic.face, names()
    fields = face.points.at(np.stack([generic.keys[name] for name in spoken]))
    points = face.points.ids
    told = {scalar: performance.shapes[:, spoken.index(word)] for scalar, word in SCALARS.items()}
    return replace(
        performance,
        points=points,
        neutral=face.points.at(face.vertices),
        motion=np.tensordot(performance.shapes, fields, axes=1),
        sigma=np.full((len(points), 3), _SIGMA),
        unseen=np.zeros((len(performance), 3)),
        scalars={**performance.scalars, **told},
    )
