"""A curve track becomes a Performance: what a take tells of its performer is found once, as a
Calibration, and every frame is read by itself against it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.capture.headfit import HeadFit, fit_heads, motion_from_neutral
from mien.capture.snakes.points import MM, POINTS, PUPIL_DISTANCE, Relief, head_model
from mien.capture.snakes.track import CurveTrack
from mien.performance.performance import Performance, Span

Array = NDArray[np.float64]

USUAL_FOCAL = 1.1
WORLD_FROM_CAMERA = np.diag([1.0, -1.0, -1.0])
SPANS = (Span("2.2", "2.3", 1, 0.4), Span("8.3", "8.4", 0, 0.7))


@dataclass(frozen=True, slots=True)
class Calibration:
    """What is known of a performer and the camera."""

    neutral: Array
    """(N, 3) mm, head frame: the points at rest."""
    open: Array
    """(2,) opening of the left and right eye at rest."""
    shut: Array
    """(2,)"""
    place: Array
    """(3,) mm, camera frame: where the head mostly is."""
    focal: float


def rays(track: CurveTrack, focal: float) -> Array:
    centre = np.array(track.size, dtype=float) / 2.0
    return (track.points - centre) / focal


def calibrate(track, relief, neutral=None, focal=None) -> Calibration:
    focal = focal or USUAL_FOCAL * track.size[0]
    seen = np.flatnonzero(~track.lost)
    rest = seen[:15]
    # neutral places: patch-units → mm via eyes in each rest frame
    pts = track.points[rest]
    mids = np.stack([pts[:, [22, 23]].mean(1), pts[:, [20, 21]].mean(1)], 1)
    d = mids[:, 1] - mids[:, 0]
    s = 66.1 / np.linalg.norm(d, axis=1)
    c, n = d[:, 0] / np.linalg.norm(d, axis=1), d[:, 1] / np.linalg.norm(d, axis=1)
    R = np.stack([np.stack([c, n], 1), np.stack([-n, c], 1)], 1)
    xy = np.einsum("fij,fnj->fni", R, pts - mids.mean(1)[:, None]) * s[:, None, None] * [1, -1]
    model = np.concatenate([np.median(xy, 0), relief.depth[:, None]], 1)
    chosen = seen[:: max(1, len(seen) // 150)]
    fit = fit_heads(head_model(model, relief), rays(track, focal)[chosen])
    op = np.median(track.opening[rest], 0)
    op = np.maximum(op, np.median(track.opening[seen], 0))
    sh = np.clip(np.quantile(track.opening[seen], 0.01, axis=0), 0.15 * op, 0.45 * op)
    return Calibration(model, op, sh, np.median(fit.translation, 0), focal)


def perform(track, known, relief, source) -> Performance:
    seen = np.flatnonzero(~track.lost)
    directions = rays(track, known.focal)[seen]
    fit = fit_heads(head_model(known.neutral, relief), directions)
    motion = motion_from_neutral(known.neutral, directions, fit)
    hold = np.maximum(np.cumsum(~track.lost) - 1, 0)
    cl = ((known.open - track.opening) / (known.open - known.shut))[seen][hold]
    P = len(POINTS)
    F = len(track)
    return Performance(
        points=POINTS,
        neutral=known.neutral[:P],
        time=track.time,
        motion=motion[:, :P][hold],
        sigma=np.full((P, 3), 1.5),
        rotation=(WORLD_FROM_CAMERA @ fit.rotation)[hold],
        translation=(fit.translation @ WORLD_FROM_CAMERA)[hold],
        gaze=np.zeros((F, 2, 2)),
        confidence=np.where(track.lost, 0.0, 1.0),
        lost=track.lost,
        unseen=fit.rotation[:, 2][hold],
        rest_translation=known.place @ WORLD_FROM_CAMERA,
        spans=SPANS,
        scalars={"lid_left": cl[:, 0], "lid_right": cl[:, 1]},
        source=source,
    )
