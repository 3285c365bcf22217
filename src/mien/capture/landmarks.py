"""A landmark track becomes a Performance.

What a take tells of its performer (neutral, lids, gaze at rest) is found once, as a Calibration;
every frame is then read by itself against it, so that live and offline give the same numbers.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.capture import gaze as eyes
from mien.capture import lids
from mien.capture.headfit import HeadFit, fit_heads, motion_from_neutral, residuals
from mien.capture.neutral import Ground, find, head_model, own_neutral, refine, samples
from mien.capture.track import ROW, LandmarkTrack
from mien.errors import InputError
from mien.performance.performance import Performance, Span
from mien.vocabulary.landmarks import FACE_LANDMARKS, feature_points

Array = NDArray[np.float64]

USUAL_FOCAL = 1.1
"""Focal length of an unknown camera, in picture widths; the fit hardly depends on it."""

WORLD_FROM_CAMERA = np.diag([1.0, -1.0, -1.0])

POINTS = tuple(feature_points())
POINT_ROWS = np.array([ROW[i] for i in feature_points().values()])
_FACE_ROWS = np.array([row for i, row in ROW.items() if i < FACE_LANDMARKS])


def by_region(**values: float) -> Array:
    """(P,) one value a feature point, by the region it lies in."""
    region = {"2": "lips", "3": "lids", "4": "brows", "5": "cheeks", "8": "lips", "9": "nose"}
    special = {"2.1": "chin", "2.10": "chin"}
    special |= dict.fromkeys(("3.7", "3.8", "3.11", "3.12"), "corners")
    return np.array([values[special.get(p, region[p.split(".")[0]])] for p in POINTS])


SIGMA = by_region(lips=1.0, brows=1.5, cheeks=2.0, nose=1.5, chin=3.0, lids=1.0, corners=2.0)
"""(P,) mm, standard error of the network's points."""
GAIN = by_region(lips=1.15, brows=2.0, cheeks=1.6, nose=1.6, chin=1.6, lids=1.0, corners=1.0)
"""(P,) the network under-reports motion, each region by its own factor; this undoes it."""
SPANS = (
    *(
        Span(upper, lower, 1, 0.2)
        for upper, lower in (("2.2", "2.3"), ("2.6", "2.8"), ("2.7", "2.9"))
    ),
    Span("8.3", "8.4", 0, 0.7),
)
"""Lip opening and mouth width are seen better than either of their ends."""


@dataclass(frozen=True, slots=True)
class Calibration:
    """What is known of a performer and the camera."""

    model: Array
    """(N, 3) mm, head frame: the tracked landmarks of the face that is fitted."""
    offset: Array
    """(N, 3) mm, what the neutral frames still show as motion against ``model``: the network's
    constant error. The performer's neutral is ``model + offset``."""
    lids: lids.LidRange
    gaze: Array
    """(2, 2) raw gaze at rest."""
    place: Array
    """(3,) mm, camera frame: where the head mostly is."""
    focal: float
    """Pixels."""


def rays(track: LandmarkTrack, focal: float) -> Array:
    """(F, N, 2) directions x/z, y/z of the tracked points in the camera frame."""
    centre = np.array(track.size, dtype=float) / 2.0
    return (track.points[..., :2].astype(float) - centre) / focal


def calibrate(
    track: LandmarkTrack,
    ground: Ground,
    *,
    neutral: tuple[float, float] | None = None,
    focal: float | None = None,
) -> Calibration:
    """Learn the performer from a take.

    ``neutral`` names the seconds (first, last) in which the face rests; without it the most
    neutral stretch is found. ``focal`` in pixels. Raises InputError where no face is seen in the
    seconds named.
    """
    focal = focal or USUAL_FOCAL * track.size[0]
    seen = np.flatnonzero(~track.lost)
    points, directions = track.points[seen], rays(track, focal)[seen]
    rest = rest_of(track, ground, neutral=neutral, focal=focal)
    chosen = samples(len(seen))
    place = refine(own_neutral(points[rest], ground), directions[chosen], ground)
    _, resting = _read(place, directions[rest], ground)
    fit, motion = _read(place, directions[chosen], ground)
    opening, opening_at_rest = (lids.openings(place + each, place) for each in (motion, resting))
    lid_range = lids.lid_range(opening, opening_at_rest)
    turn = facing(fit)
    closure = lids.closures(opening, lid_range, turn[:, 0])
    return Calibration(
        model=place,
        offset=np.median(resting, axis=0),
        lids=lid_range,
        gaze=eyes.gaze_rest(eyes.raw_gaze(place + motion), turn, closure),
        place=np.median(fit.translation, axis=0),
        focal=focal,
    )


def with_shut(known: Calibration, track: LandmarkTrack, ground: Ground) -> Calibration:
    """``known`` with the lids as ``track`` shows them, in which both eyes are shut. Raises
    InputError where they are not."""
    _, motion = _read(known.model, rays(track, known.focal), ground)
    shut = lids.openings(known.model + motion, known.model)
    return replace(known, lids=lids.with_shut(known.lids, shut))


def rest_of(
    track: LandmarkTrack,
    ground: Ground,
    *,
    neutral: tuple[float, float] | None = None,
    focal: float | None = None,
) -> slice:
    """The stretch in which the face rests, among the frames that show one. Arguments and errors
    as of ``calibrate``."""
    seen = np.flatnonzero(~track.lost)
    if neutral is not None:
        return _named(track.time[seen], neutral)
    directions = rays(track, focal or USUAL_FOCAL * track.size[0])[seen]
    return find(track.time[seen], track.points[seen], directions, ground)


def perform(track: LandmarkTrack, known: Calibration, ground: Ground, source: str) -> Performance:
    """Read every frame of ``track`` against what is known of the performer."""
    seen = np.flatnonzero(~track.lost)
    directions = rays(track, known.focal)[seen]
    fit, motion = _read(known.model, directions, ground)
    lifted = known.model + motion
    turn = facing(fit)
    closure = lids.closures(lids.openings(lifted, known.model), known.lids, turn[:, 0])
    scale = known.focal / fit.translation[:, 2:]
    closure = lids.paired(closure, scale * lids.eye_widths(known.model) * known.lids.open)
    kept = hold(track.lost)
    return Performance(
        points=POINTS,
        neutral=(known.model + known.offset)[POINT_ROWS],
        time=track.time,
        motion=((motion - known.offset)[:, POINT_ROWS] * GAIN[:, None])[kept],
        sigma=np.repeat(SIGMA[:, None], 3, axis=1),
        rotation=(WORLD_FROM_CAMERA @ fit.rotation)[kept],
        translation=(fit.translation @ WORLD_FROM_CAMERA)[kept],
        gaze=eyes.gaze(eyes.raw_gaze(lifted), known.gaze, closure)[kept],
        confidence=np.where(track.lost, 0.0, _confidence(known, directions, fit, ground)[kept]),
        lost=track.lost,
        unseen=fit.rotation[:, 2][kept],
        rest_translation=known.place @ WORLD_FROM_CAMERA,
        spans=SPANS,
        scalars={"lid_left": closure[kept, 0], "lid_right": closure[kept, 1]},
        source=source,
        faces=track.faces,
    )


def _read(place: Array, directions: Array, ground: Ground) -> tuple[HeadFit, Array]:
    fit = fit_heads(head_model(place, ground), directions[:, _FACE_ROWS])
    return fit, motion_from_neutral(place, directions, fit)


def facing(fit: HeadFit) -> Array:
    """(F, 2) yaw (+ to the performer's left) and pitch (+ up) of the head."""
    x, y, z = np.moveaxis(fit.rotation[:, :, 2], -1, 0)
    return np.stack([np.arctan2(x, -z), np.arcsin(np.clip(-y, -1.0, 1.0))], axis=1)


def _confidence(known: Calibration, directions: Array, fit: HeadFit, ground: Ground) -> Array:
    """(F,) 1 where the points lie as a face can, falling with what no face explains (mm rms)."""
    model = head_model(known.model, ground)
    residual = residuals(model, directions[:, _FACE_ROWS], fit)
    rms = np.sqrt((residual**2).sum(-1).mean(1))
    return np.asarray(1.0 / (1.0 + (rms / 4.0) ** 2))


def hold(lost: NDArray[np.bool_]) -> NDArray[np.intp]:
    """(F,) which seen frame stands for each frame: itself, the last one seen, or the first."""
    return np.asarray(np.maximum(np.cumsum(~lost) - 1, 0))


def _named(time: Array, span: tuple[float, float]) -> slice:
    inside = np.flatnonzero((time >= span[0] - 1e-6) & (time <= span[1] + 1e-6))
    if len(inside) == 0:
        raise InputError(
            f"--neutral: no face is seen between {span[0]:g} and {span[1]:g} s; "
            f"the take shows one from {time[0]:g} to {time[-1]:g} s"
        )
    return slice(int(inside[0]), int(inside[-1]) + 1)
