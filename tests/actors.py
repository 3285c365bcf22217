"""Characters that perform: their own key models, as a camera would see them."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from mien.capture.landmarks import POINTS, SIGMA, SPANS
from mien.face.character import Character
from mien.face.library import load_character
from mien.performance.acted import acted
from mien.performance.performance import Performance
from mien.vocabulary.fdp import feature_points

Array = NDArray[np.float64]

FACE_ON = np.array([0.0, 0.0, 1.0])

built_in = cache(load_character)


def shown(
    character: Character,
    weights: Array,
    *,
    unseen: Array | None = None,
    size: float = 1.0,
    noise: Array | None = None,
    scalars: dict[str, Array] | None = None,
) -> Performance:
    """``character`` showing its examples at ``weights`` (F, K), ``size`` times as large."""
    face = character.face
    there = [i for i, fdp in enumerate(POINTS) if fdp in face.points.ids]
    rows = face.points.index([POINTS[i] for i in there])
    keys = [character.keys.names.index(name) for name in character.examples]
    fields = face.points.at(character.keys.displacements[keys].astype(float))[:, rows]
    motion = size * np.tensordot(weights, fields, axes=1)
    return acted(
        [POINTS[i] for i in there],
        size * face.points.at(face.vertices)[rows],
        motion if noise is None else motion + noise,
        sigma=size * SIGMA[there],
        unseen=unseen,
        spans=[type(span)(span.first, span.second, span.axis, size * span.sigma) for span in SPANS],
        scalars=scalars,
    )


def mirrored(performance: Performance) -> Performance:
    """The same seen in a mirror."""
    flip = np.array([-1.0, 1.0, 1.0])
    partner = [feature_points()[fdp].mirror for fdp in performance.points]
    rows = [partner.index(fdp) for fdp in performance.points]
    return acted(
        performance.points,
        performance.neutral[rows] * flip,
        performance.motion[:, rows] * flip,
        sigma=performance.sigma[rows, 0],
        unseen=performance.unseen * flip,
        spans=performance.spans,
        scalars={
            "lid_left": performance.scalars["lid_right"],
            "lid_right": performance.scalars["lid_left"],
        }
        if performance.scalars
        else None,
    )
