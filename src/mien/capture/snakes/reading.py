"""A curve track becomes a Performance.

What a take tells of its performer (neutral, lids) is found once, as a Calibration; every frame is
then read by itself against it, so that live and offline give the same numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.capture import lids
from mien.capture.gaze import gaze, gaze_rest
from mien.capture.headfit import HeadFit, motion_from_neutral
from mien.capture.landmarks import USUAL_FOCAL, WORLD_FROM_CAMERA, facing
from mien.capture.snakes.curves.features import LASTING, MOUTH, ROW, usual_features
from mien.capture.snakes.curves.lens import height
from mien.capture.snakes.points import MM, POINTS, places
from mien.capture.snakes.track import CurveTrack
from mien.errors import InputError
from mien.numeric.rotation import from_vector
from mien.performance.performance import Performance, Span

Array = NDArray[np.float64]

_LIPS, _CORNERS, _INNER, _LIDS = (1.5, 1.2), (1.5, 1.5), (1.5, 1.2), (3.0, 1.0)
_BROW, _BROW_END = (4.0, 1.2), (4.0, 1.8)
_SIGMAS = {
    **dict.fromkeys(("4.1", "4.2", "4.5", "4.6"), _BROW_END),
    **dict.fromkeys(("4.3", "4.4"), _BROW),
    **dict.fromkeys(("3.1", "3.2", "3.3", "3.4"), _LIDS),
    **dict.fromkeys(("8.3", "8.4"), _CORNERS),
    **dict.fromkeys(("8.1", "8.2", "8.5", "8.6", "8.7", "8.8"), _LIPS),
    **dict.fromkeys(("2.2", "2.3"), _INNER),
}
SIGMA = np.array([(*_SIGMAS[point], _SIGMAS[point][0]) for point in POINTS])
"""(P, 3) mm. A curve is known across and hardly along."""
SPANS = (Span("2.2", "2.3", 1, 0.4), Span("8.3", "8.4", 0, 1.0))

_WINDOW = 0.5
"""Seconds for which a face rests when it rests."""
PUPIL_RADIUS = 12.0 / MM
"""Patch units from the centre of an eyeball to its pupil."""
_FARTHEST_LOOK = np.radians(35.0)
"""Eyes turn no farther from rest before the head does: what looks farther is a lash or a shadow."""
EYES_DEPTH = 12.0
"""mm the corners of the eyes lie in front of the head's origin."""


@dataclass(frozen=True, slots=True)
class Calibration:
    """What is known of a performer and the camera."""

    neutral: Array
    """(P, 3) mm, head frame: the points at rest."""
    lids: lids.LidRange
    """Heights of the eyes, patch units."""
    gaze: Array
    """(2, 2) raw gaze at rest."""
    place: Array
    """(3,) mm, camera frame: where the head mostly is."""
    focal: float
    """Pixels."""


def resting(track: CurveTrack, neutral: tuple[float, float] | None = None) -> NDArray[np.intp]:
    """Frames in which the face rests: those of the seconds named, or the stretch that is quiet,
    shut, open-eyed, near what the face mostly is and what faces mostly are; rather early.

    Raises InputError where no face is seen in the seconds named.
    """
    seen = np.flatnonzero(~track.lost)
    time = track.time[seen]
    if neutral is not None:
        named = seen[(time >= neutral[0] - 1e-6) & (time <= neutral[1] + 1e-6)]
        if len(named) == 0:
            raise InputError(
                f"--neutral: no face is seen between {neutral[0]:g} and {neutral[1]:g} s; "
                f"the take shows one from {time[0]:g} to {time[-1]:g} s"
            )
        return named
    lenses = track.lenses[seen]
    away = np.abs(lenses - np.median(lenses, axis=0)).mean(axis=(1, 2, 3))
    opening = track.opening[seen].mean(axis=1)
    wide = np.quantile(opening, 0.8)
    strange = np.abs(lenses[:, :MOUTH] - usual_features()).mean(axis=(1, 2, 3))
    score = (
        0.5 * away
        + strange
        + 0.3 * height(lenses[:, MOUTH])
        + 3.0 * track.missed[seen][:, LASTING].mean(axis=1)
    )
    score += np.clip(0.7 * wide - opening, 0.0, None)
    pace = float(np.median(np.diff(time))) if len(time) > 1 else _WINDOW
    window = min(len(seen), max(1, round(_WINDOW / max(pace, 1e-3))))
    mean = np.convolve(score, np.full(window, 1.0 / window), "valid")
    best = int(np.argmin(mean + np.linspace(0.0, 1.0, len(mean))))
    return seen[best : best + window]


def calibrate(
    track: CurveTrack,
    depth: Array,
    *,
    neutral: tuple[float, float] | None = None,
    focal: float | None = None,
) -> Calibration:
    """Learn the performer from a take; ``depth`` (P,) is the generic face's, ``neutral`` and
    ``focal`` are as for the capture."""
    focal = focal or USUAL_FOCAL * track.size[0]
    seen, rest = np.flatnonzero(~track.lost), resting(track, neutral)
    flat = places(np.median(track.lenses[rest], axis=0)) * np.array([MM, -MM])
    model = np.column_stack([flat, depth])
    head = heads(track, focal)
    offset = np.median(_motion(track, model, head, focal)[rest], axis=0)
    lid_range = lids.lid_range(track.opening[seen], track.opening[rest])
    turn = facing(head)
    closure = lids.closures(track.opening, lid_range, turn[:, 0])
    return Calibration(
        neutral=model + offset,
        lids=lid_range,
        gaze=gaze_rest(_raw_gaze(track)[seen], turn[seen], _hidden(track, closure)[seen]),
        place=np.median(head.translation[seen], axis=0),
        focal=focal,
    )


def heads(track: CurveTrack, focal: float) -> HeadFit:
    """Pose of every frame: the turn that was seen along the line to the head, and the place at
    which eyes are as far apart as they look."""
    depth = focal * MM * track.scale
    sight = (track.centre - np.array(track.size) / 2.0) / focal
    ray = np.concatenate([sight, np.ones((len(track), 1))], axis=1)
    turn = _towards(ray) @ track.rotation
    place = ray * depth[:, None] - EYES_DEPTH * turn[:, :, 2]
    return HeadFit(turn, place, np.zeros((len(track), 0)))


def perform(track: CurveTrack, known: Calibration, source: str) -> Performance:
    """Read every frame of ``track`` against what is known of the performer."""
    head = heads(track, known.focal)
    motion = _motion(track, known.neutral, head, known.focal)
    closure = lids.closures(track.opening, known.lids, facing(head)[:, 0])
    reach = _FARTHEST_LOOK
    looks = np.clip(_raw_gaze(track), known.gaze - reach, known.gaze + reach)
    hold = _hold(track.lost)
    share = 1.0 - track.missed[:, LASTING].mean(axis=1)
    return Performance(
        points=POINTS,
        neutral=known.neutral,
        time=track.time,
        motion=motion[hold],
        sigma=SIGMA,
        rotation=(WORLD_FROM_CAMERA @ head.rotation)[hold],
        translation=(head.translation @ WORLD_FROM_CAMERA)[hold],
        gaze=gaze(looks, known.gaze, _hidden(track, closure))[hold],
        confidence=np.where(track.lost, 0.0, share),
        lost=track.lost,
        unseen=head.rotation[:, 2][hold],
        rest_translation=known.place @ WORLD_FROM_CAMERA,
        spans=SPANS,
        scalars={
            "lid_left": closure[hold, 0],
            "lid_right": closure[hold, 1],
            "tongue_out": track.tongue[hold],
            "mouth_seen": np.where(track.missed[:, ROW["lips"]], 0.0, 1.0),
        },
        source=source,
    )


def _motion(track: CurveTrack, neutral: Array, head: HeadFit, focal: float) -> Array:
    """(F, P, 3) mm in the head frame."""
    rays = (track.points - np.array(track.size) / 2.0) / focal
    return motion_from_neutral(neutral, rays, head)


def _hold(lost: NDArray[np.bool_]) -> NDArray[np.intp]:
    """(F,) which frame stands for each: itself, the last one seen, or the first."""
    seen = np.flatnonzero(~lost)
    return np.asarray(seen[np.maximum(np.cumsum(~lost) - 1, 0)])


def _towards(ray: Array) -> Array:
    """(F, 3, 3) the least turn that brings +z onto ``ray`` (F, 3)."""
    unit = ray / np.linalg.norm(ray, axis=1, keepdims=True)
    axis = np.stack([-unit[:, 1], unit[:, 0], np.zeros(len(unit))], axis=1)
    sine = np.linalg.norm(axis, axis=1, keepdims=True)
    angle = np.arctan2(sine, unit[:, 2:])
    return from_vector(axis / np.maximum(sine, 1e-12) * angle)


def _raw_gaze(track: CurveTrack) -> Array:
    """(F, 2, 2) yaw (+ left) and pitch (+ up) of the left and right eye, from an unknown rest."""
    aside = track.irises * np.array([1.0, -1.0]) / PUPIL_RADIUS
    return np.asarray(np.arcsin(np.clip(aside, -0.95, 0.95)))


def _hidden(track: CurveTrack, closure: Array) -> Array:
    """(F, 2) how far lids hide the left and the right iris: a lid in shadow may be down though its
    curves (``closure``) are not."""
    return np.maximum(closure, 1.0 - track.plain)
