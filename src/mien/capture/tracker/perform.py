"""Tracked states become a Performance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from mien.capture import gaze as eyes
from mien.capture import lids
from mien.capture.headfit import HeadFit, motion_from_neutral
from mien.capture.landmarks import (
    GAIN,
    POINT_ROWS,
    POINTS,
    SIGMA,
    SPANS,
    WORLD_FROM_CAMERA,
    Calibration,
    facing,
    hold,
    rays,
)
from mien.capture.track import LandmarkTrack
from mien.capture.tracker.meet import ROWS, VERTICES, Meeting
from mien.capture.tracker.track import Found
from mien.performance.performance import Performance

Array = NDArray[np.float64]


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
    motion = motion_from_neutral(neutral, directions, fit) - offset
    lifted = neutral + motion
    turn = facing(fit)
    closure = lids.closures(lids.openings(lifted, known.model), known.lids, turn[:, 0])
    kept = hold(track.lost)
    confidence = np.array([each.confidence for each in found])
    return Performance(
        points=POINTS,
        neutral=neutral[POINT_ROWS],
        time=track.time,
        motion=(motion[:, POINT_ROWS] * GAIN[:, None])[kept],
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
