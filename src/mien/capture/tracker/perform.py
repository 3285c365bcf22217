"""Tracked states become a Performance."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mien.capture.headfit import HeadFit, motion_from_neutral
from mien.capture.landmarks import (
    POINT_ROWS,
    POINTS,
    WORLD_FROM_CAMERA,
    Calibration,
    by_region,
    hold,
    rays,
)
from mien.capture.track import KEPT, LandmarkTrack
from mien.capture.tracker.meet import ROWS, VERTICES, Meeting
from mien.capture.tracker.track import Found
from mien.performance.performance import Performance

Array = NDArray[np.float64]

LANDMARKS = by_region(lips=1.15, lids=0.3, brows=1.1, cheeks=0.55, nose=0.15, chin=0.4, corners=0.3)
SKIN = by_region(lips=0.0, lids=0.5, brows=0.6, cheeks=0.4, nose=1.3, chin=0.8, corners=0.5)
"""(P,) what a point's motion owes to its landmark, and to the tracked surface. Lips have edges that
the network knows; nose and chin are skin, of which it tells little (see
docs/decisions/tracker.md)."""
_NONE = dict.fromkeys(("lips", "lids", "brows", "cheeks", "nose", "chin", "corners"), 0.0)
_LIPS, _BROWS, _CORNERS = (
    by_region(**{**_NONE, region: 1.0}).astype(bool) for region in ("lips", "brows", "corners")
)
"""(P,) points of a region. Brows move against the corners of the eyes, which are bone: in a film
of real frowns the network's error at a bowed head carried both up by 4 mm, and the frown away."""
_MOUTH = 0.4
"""Skin says where the mouth is, and only landmarks what its lips do: of lips that are pressed, the
skin around tells that they are open."""
_DOUBT, _STEEP = 1.6, 4
"""Times the usual disagreement of looks at which half the confidence is gone, and how fast."""
_LEAST = 0.1
"""Disagreement that everybody has."""
_PUFF, _FLAT, _ROUND = "cheek_puff", 0.2, 0.35
"""Weights from which cheeks count as blown up, and fully so."""
_PARTED = 3.0
"""mm between lips through which all air is gone."""
_UPPER, _LOWER = POINTS.index("2.2"), POINTS.index("2.3")


def perform(
    track: LandmarkTrack,
    found: Sequence[Found],
    met: Meeting,
    known: Calibration,
    plain: Performance,
) -> Performance:
    """The performance of ``track``, whose frames that show a face are ``found`` in their order.

    Head and surface are the tracker's. Lids, gaze and what else is read beside them come from the
    ``plain`` performance of the landmarks: so near a point, the pose of the whole head is too far.
    """
    neutral = known.model.copy()
    neutral[ROWS] = met.person.neutral[VERTICES]
    offset = np.zeros_like(neutral)
    offset[ROWS] = np.column_stack([met.person.offset, np.zeros(len(ROWS))]) @ met.rest.rotation
    states = [each.state for each in found]
    fit = HeadFit(
        np.array([s.rotation for s in states]),
        np.array([s.translation for s in states]),
        np.array([s.weights for s in states]),
    )
    seen = motion_from_neutral(neutral, rays(track, known.focal)[~track.lost], fit) - offset
    skin = np.einsum("fk,pkx->fpx", fit.weights, _point_shapes(met))
    points = seen[:, POINT_ROWS]
    points[:, _BROWS] -= points[:, _CORNERS].mean(axis=1, keepdims=True)
    motion = LANDMARKS[:, None] * points + SKIN[:, None] * skin
    lips = skin[:, _LIPS] - points[:, _LIPS]
    motion[:, _LIPS] += _MOUTH * lips.mean(axis=1, keepdims=True)
    confidence = confidences(np.array([each.cost for each in found]))
    parted = points[:, _UPPER, 1] - points[:, _LOWER, 1]
    kept = hold(track.lost)
    return replace(
        plain,
        neutral=neutral[POINT_ROWS],
        motion=motion[kept],
        rotation=(WORLD_FROM_CAMERA @ fit.rotation)[kept],
        translation=(fit.translation @ WORLD_FROM_CAMERA)[kept],
        confidence=np.where(track.lost, 0.0, confidence[kept]),
        unseen=fit.rotation[:, 2][kept],
        scalars={
            **plain.scalars,
            "cheek_puff": (confidence * _puff(fit.weights, parted, met))[kept],
        },
    )


def confidences(costs: Array) -> Array:
    """(F,) 0..1 from how badly the looks of each frame agree with that at rest. Skins differ, and
    so do films: a frame is doubted when it agrees much less than this take's frames mostly do."""
    usual = max(float(np.quantile(costs, 0.3)), _LEAST)
    return np.asarray(1.0 / (1.0 + (costs / (_DOUBT * usual)) ** _STEEP))


def _puff(weights: Array, parted: Array, met: Meeting) -> Array:
    """(F,) how far the cheeks are blown up, which no landmark shows, of ``weights`` (F, K); lips
    that have ``parted`` by as many mm (F,) hold no air."""
    names = met.person.space.names
    if _PUFF not in names:
        return np.zeros(len(weights))
    level = weights[:, names.index(_PUFF)]
    shut = np.clip(1.0 - parted / _PARTED, 0.0, 1.0)
    return np.asarray(shut * np.clip((level - _FLAT) / (_ROUND - _FLAT), 0.0, 1.0))


def _point_shapes(met: Meeting) -> Array:
    """(P, K, 3) motion of the feature points at weight 1 of each expression."""
    vertices = np.array(KEPT)[POINT_ROWS]
    return np.moveaxis(met.person.space.expression[:, vertices], 0, 1)
