"""Tracked states become a Performance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mien.capture import gaze as eyes
from mien.capture import lids
from mien.capture.headfit import HeadFit, motion_from_neutral
from mien.capture.landmarks import (
    POINT_ROWS,
    POINTS,
    SIGMA,
    SPANS,
    WORLD_FROM_CAMERA,
    Calibration,
    by_region,
    facing,
    hold,
    rays,
)
from mien.capture.track import KEPT, LandmarkTrack
from mien.capture.tracker.meet import ROWS, VERTICES, Meeting
from mien.capture.tracker.track import Found
from mien.performance.performance import Performance

Array = NDArray[np.float64]

LANDMARKS = by_region(lips=0.95, lids=0.3, brows=0.2, cheeks=0.55, nose=0.15, chin=0.4, corners=0.3)
SKIN = by_region(lips=0.2, lids=0.5, brows=0.9, cheeks=0.4, nose=1.3, chin=0.8, corners=0.5)
"""(P,) what a point's motion owes to its landmark, and to the tracked surface. Lips have edges that
the network knows; brows, nose and chin are skin, of which it tells little (see
docs/decisions/tracker.md)."""
_DOUBT, _STEEP = 1.6, 4
"""Times the usual disagreement of looks at which half the confidence is gone, and how fast."""
_LEAST = 0.1
"""Disagreement that everybody has."""


def perform(
    track: LandmarkTrack,
    found: Sequence[Found],
    met: Meeting,
    known: Calibration,
    source: str,
) -> Performance:
    """The performance of ``track``, whose frames that show a face are ``found`` in their order.

    The head is the tracker's; points are where the landmarks lie against that head, less what they
    miss at rest.
    """
    neutral = known.model.copy()
    neutral[ROWS] = met.person.neutral[VERTICES]
    offset = np.zeros_like(neutral)
    offset[ROWS] = np.column_stack([met.person.offset, np.zeros(len(ROWS))]) @ met.rest.rotation
    directions = rays(track, known.focal)[~track.lost]
    states = [each.state for each in found]
    fit = HeadFit(
        np.array([s.rotation for s in states]),
        np.array([s.translation for s in states]),
        np.array([s.weights for s in states]),
    )
    seen = motion_from_neutral(neutral, directions, fit) - offset
    skin = np.einsum("fk,pkx->fpx", fit.weights, _point_shapes(met))
    motion = LANDMARKS[:, None] * seen[:, POINT_ROWS] + SKIN[:, None] * skin
    lifted = neutral + seen
    turn = facing(fit)
    closure = lids.closures(lids.openings(lifted, known.model), known.lids, turn[:, 0])
    kept = hold(track.lost)
    confidence = confidences(np.array([each.cost for each in found]))
    return Performance(
        points=POINTS,
        neutral=neutral[POINT_ROWS],
        time=track.time,
        motion=motion[kept],
        sigma=np.repeat(SIGMA[:, None], 3, axis=1),
        rotation=(WORLD_FROM_CAMERA @ fit.rotation)[kept],
        translation=(fit.translation @ WORLD_FROM_CAMERA)[kept],
        gaze=eyes.gaze(eyes.raw_gaze(lifted), known.gaze, closure)[kept],
        confidence=np.where(track.lost, 0.0, confidence[kept]),
        lost=track.lost,
        unseen=fit.rotation[:, 2][kept],
        rest_translation=known.place @ WORLD_FROM_CAMERA,
        spans=SPANS,
        scalars={"lid_left": closure[kept, 0], "lid_right": closure[kept, 1]},
        source=source,
    )


def confidences(costs: Array) -> Array:
    """(F,) 0..1 from how badly the looks of each frame agree with that at rest. Skins differ, and
    so do films: a frame is doubted when it agrees much less than this take's frames mostly do."""
    usual = max(float(np.quantile(costs, 0.3)), _LEAST)
    return np.asarray(1.0 / (1.0 + (costs / (_DOUBT * usual)) ** _STEEP))


def _point_shapes(met: Meeting) -> Array:
    """(P, K, 3) motion of the feature points at weight 1 of each expression."""
    vertices = np.array(KEPT)[POINT_ROWS]
    return np.moveaxis(met.person.space.expression[:, vertices], 0, 1)
