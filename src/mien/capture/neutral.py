"""The performer's own neutral: which frames show it, and where its points lie in space.

The network's depth is used here and nowhere else; what the take itself shows from other sides
then corrects it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.capture.headfit import (
    FRONTAL,
    HeadFit,
    HeadModel,
    fit_heads,
    motion_from_neutral,
    residuals,
)
from mien.capture.track import KEPT, ROW
from mien.face.character import Character
from mien.numeric.procrustes import align
from mien.vocabulary.landmarks import EYE_CORNERS, FACE_LANDMARKS, IRIS, LOWER_LID, RIGID, UPPER_LID

Array = NDArray[np.float64]

PUPIL_DISTANCE = 63.0
"""mm between the pupils: a single camera has no scale, so everybody is given the usual one."""

WINDOW = 0.5
"""Seconds for which a face rests when it rests."""

_SAMPLES = 150
"""Frames of a take that are looked at to calibrate it; more change nothing but the time."""
_BONE_SIGMA = 3.0
"""mm, how wrong a point over bone may be in the network's neutral; other views settle it."""
_SOFT_SIGMA = (0.3, 0.3, 0.7)
"""mm along x, y, z for all others: expressions move them and must not pass for another neutral."""
_INDEPENDENT = 60.0
"""Frames of a take that count as independent observations: neighbours repeat each other's bias."""

_PUPIL_DEPTH = 4.0
"""mm the pupil lies in front of the eye's corners. The iris network's own depth is worthless, and
a wrong one makes eyes roll as the head turns."""

_RIGID_ROWS = np.array([ROW[i] for i in RIGID])
_MESH_ROWS = np.array([row for i, row in ROW.items() if i < FACE_LANDMARKS])
_PRECISION = np.tile(1.0 / np.array(_SOFT_SIGMA) ** 2, (len(_MESH_ROWS), 1))
_PRECISION[_RIGID_ROWS] = 1.0 / _BONE_SIGMA**2


@dataclass(frozen=True, slots=True)
class Ground:
    """The generic face as the detector's points see it, with pupils PUPIL_DISTANCE apart."""

    neutral: Array
    """(M, 3) mm, of the tracked landmarks that lie on the face (the first rows of a track)."""
    shapes: Array
    """(K, M, 3) mm."""


def ground(generic: Character) -> Ground:
    """What the capture needs of the generic face."""
    kept = np.array([i for i in KEPT if i < FACE_LANDMARKS])
    eyes = generic.face.pivots
    scale = PUPIL_DISTANCE / float(np.linalg.norm(eyes["eye_left"] - eyes["eye_right"]))
    rows = [generic.keys.names.index(name) for name in generic.examples]
    shapes = generic.keys.displacements[rows][:, kept].astype(float) * scale
    # Laid out point by point, as HeadModel reads them, so that no frame has to do it again.
    shapes = np.ascontiguousarray(shapes.transpose(1, 2, 0)).transpose(2, 0, 1)
    return Ground(generic.face.vertices[kept] * scale, shapes)


def lift(points: NDArray[np.float32], ground: Ground) -> Array:
    """Landmarks (F, N, 3) as the network sees them, brought upright: (F, N, 3) mm, head frame."""
    upright = points.astype(float) @ FRONTAL
    lifted = np.empty_like(upright)
    for frame, place in enumerate(upright):
        lifted[frame] = align(place[_RIGID_ROWS], ground.neutral[_RIGID_ROWS])(place)
    return lifted


def own_neutral(points: NDArray[np.float32], ground: Ground) -> Array:
    """(N, 3) mm: the performer's neutral from the frames (F, N, 3) that show it."""
    neutral = np.median(lift(points, ground), axis=0)
    pupils = neutral[ROW[IRIS[0]]] - neutral[ROW[IRIS[1]]]
    neutral *= PUPIL_DISTANCE / np.linalg.norm(pupils[:2])
    return np.asarray(neutral)


def head_model(neutral: Array, ground: Ground) -> HeadModel:
    """What is fitted to a picture: the face's rows of ``neutral`` with the generic shapes."""
    return HeadModel(neutral[_MESH_ROWS], ground.shapes, _RIGID_ROWS)


def refine(neutral: Array, rays: Array, ground: Ground, rounds: int = 2) -> Array:
    """Correct the depth of ``neutral`` (N, 3) by what other views of the take show.

    Given each frame's pose and shapes, a neutral point is a linear least-squares problem over all
    frames; pose and points are found in turns, as in bundle adjustment. ``rays`` (F, N, 2).
    """
    neutral = neutral.copy()
    seen = rays[:, _MESH_ROWS]
    share = min(1.0, _INDEPENDENT / len(rays))
    for _ in range(rounds):
        model = head_model(neutral, ground)
        fit = fit_heads(model, seen)
        neutral[_MESH_ROWS] += _correction(model, seen, fit, share)
    for iris, corners in zip(IRIS, EYE_CORNERS, strict=True):
        neutral[ROW[iris], 2] = neutral[[ROW[i] for i in corners], 2].mean() + _PUPIL_DEPTH
    return neutral


def _correction(model: HeadModel, rays: Array, fit: HeadFit, share: float) -> Array:
    residual = residuals(model, rays, fit)
    trust = share / (1.0 + (residual**2).sum(-1) / 2.5**2)
    slope = rays[..., None] * fit.rotation[:, None, 2:] - fit.rotation[:, None, :2]
    normal = np.einsum("fn,fnai,fnaj->nij", trust, slope, slope)
    right = -np.einsum("fn,fnai,fna->ni", trust, slope, residual)
    step = np.linalg.solve(normal + _PRECISION[:, None] * np.eye(3), right[..., None])
    return np.asarray(step[..., 0])


def samples(frames: int) -> NDArray[np.intp]:
    """Evenly spaced frames that stand for a take."""
    return np.arange(0, frames, max(1, -(-frames // _SAMPLES)))


def find(time: Array, points: NDArray[np.float32], rays: Array, ground: Ground) -> slice:
    """The stretch of a take (F,), (F, N, 3), (F, N, 2) in which the face rests: quiet, shut,
    straight, eyes open, near what the face mostly is and what faces mostly are; rather early than
    late."""
    chosen = samples(len(points))
    pace = np.median(np.diff(time[chosen])) if len(chosen) > 1 else WINDOW
    window = min(len(chosen), max(5, round(WINDOW / max(float(pace), 1e-3))))
    usual = np.median(lift(points[chosen], ground), axis=0)
    seen = rays[chosen]
    fit = fit_heads(head_model(usual, ground), seen[:, _MESH_ROWS])
    stranger = replace(head_model(usual, ground), neutral=ground.neutral)
    tension = np.linalg.norm(fit_heads(stranger, seen[:, _MESH_ROWS]).weights, axis=1)
    shape = usual + motion_from_neutral(usual, seen, fit)

    opening = (shape[:, _UPPER, 1] - shape[:, _LOWER, 1]).mean(1)
    wide = np.quantile(opening, 0.8)
    gap = np.clip(shape[:, ROW[13], 1] - shape[:, ROW[14], 1] - 1.0, 0.0, None)
    turn = np.degrees(np.arccos(np.clip(-fit.rotation[:, 2, 2], -1.0, 1.0)))
    away = np.sqrt(((shape - np.median(shape, axis=0))[..., :2] ** 2).sum(-1).mean(1))
    unrest = _windows(shape, window).std(-1).mean((1, 2))
    narrowest = _windows(opening, window).min(-1)
    mean = _windows(0.5 * away + 0.5 * gap + 0.1 * turn + 4.0 * tension, window).mean(-1)
    lids = 2.0 * np.clip(0.6 * wide - narrowest, 0.0, None) - 0.3 * np.minimum(narrowest, wide)
    late = np.linspace(0.0, 1.0, len(mean))
    best = int(np.argmin(mean + 2.0 * unrest + lids + late))
    return slice(int(chosen[best]), int(chosen[best + window - 1]) + 1)


_UPPER = [ROW[i] for side in UPPER_LID for i in side]
_LOWER = [ROW[i] for side in LOWER_LID for i in side]


def _windows(values: Array, length: int) -> Array:
    """(F - length + 1, ..., length) every run of ``length`` frames."""
    return np.lib.stride_tricks.sliding_window_view(values, length, axis=0)
