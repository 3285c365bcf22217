"""Feature points on the curves: the 20 of [B] (N = 60 coordinates) as FDP ids."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.curves.features import MOUTH, ROW, usual_features, usual_lenses
from mien.capture.snakes.curves.lens import LOWER, UPPER, fit_lens, lower_curve, upper_curve
from mien.capture.snakes.head.relief import lifted
from mien.face.character import Character
from mien.numeric.bezier import bernstein

Array = NDArray[np.float64]

PUPIL_DISTANCE = 63.0
"""mm between the pupils: a single camera has no scale."""
EYES_APART_MM = 66.1
"""mm between the middles of the eyes of somebody whose pupils are PUPIL_DISTANCE apart."""
MM = EYES_APART_MM / 100.0
"""mm in a patch unit, in the plane of the eyes' corners."""

UP, DOWN, BOTH = "upper", "lower", "both"
_PLACES: dict[str, tuple[int, str, float]] = {
    "4.1": (ROW["brow_left"], BOTH, 0.0),
    "4.2": (ROW["brow_right"], BOTH, 1.0),
    "4.3": (ROW["brow_left"], BOTH, 0.5),
    "4.4": (ROW["brow_right"], BOTH, 0.5),
    "4.5": (ROW["brow_left"], BOTH, 1.0),
    "4.6": (ROW["brow_right"], BOTH, 0.0),
    "3.1": (ROW["eye_left"], UP, 0.5),
    "3.2": (ROW["eye_right"], UP, 0.5),
    "3.3": (ROW["eye_left"], DOWN, 0.5),
    "3.4": (ROW["eye_right"], DOWN, 0.5),
    "8.1": (ROW["lips"], UP, 0.5),
    "8.2": (ROW["lips"], DOWN, 0.5),
    "8.3": (ROW["lips"], BOTH, 1.0),
    "8.4": (ROW["lips"], BOTH, 0.0),
    "8.5": (ROW["lips"], UP, 0.72),
    "8.6": (ROW["lips"], UP, 0.28),
    "8.7": (ROW["lips"], DOWN, 0.72),
    "8.8": (ROW["lips"], DOWN, 0.28),
    "2.2": (MOUTH, UP, 0.5),
    "2.3": (MOUTH, DOWN, 0.5),
}
"""Feature point -> lens, edge and parameter from the picture's left (the subject's right) on."""
POINTS = tuple(_PLACES)


_LENS = np.array([lens for lens, _, _ in _PLACES.values()])
_EDGE = np.array([[edge != DOWN, edge != UP] for _, edge, _ in _PLACES.values()], dtype=float)
_EDGE /= _EDGE.sum(axis=1, keepdims=True)
"""(P, 2) what the upper and the lower curve count."""
_AT = np.array([at for _, _, at in _PLACES.values()])
_ENDS = (_AT == 0.0) | (_AT == 1.0)
_FARTHEST = 0.25
"""Of the parameter by which a turn may move a point along its curve."""
_TRIAL = 0.17
"""Sine of the turns by which a usual face is turned to see by how much."""
_SAMPLES = 201


def places(lenses: Array, turn: Array | None = None) -> Array:
    """(P, 2) feature points on lenses (L + 1, 6, 2), in their units.

    A curve is known across and hardly along. Where along it a point lies, the head's ``turn``
    (3, 3, x right, y down, z away) says: of a mouth that is seen from the side, the far half is
    short.
    """
    return np.asarray(np.einsum("pc,pcx->px", bernstein(_at(turn)), _curves(lenses)))


def _at(turn: Array | None) -> Array:
    """(P,) the parameter of each point on its curve."""
    if turn is None:
        return _AT
    slid = _slides() @ turn[:2, 2]
    return np.asarray(_AT + np.clip(slid, -_FARTHEST, _FARTHEST))


def _curves(lenses: Array) -> Array:
    """(P, 4, 2) control points of the curve that each point lies on."""
    curves = lenses[_LENS][:, np.stack([UPPER, LOWER])]
    return np.asarray(np.einsum("pe,pecx->pcx", _EDGE, curves))


@cache
def _slides() -> Array:
    """(P, 2) by how much of the parameter a point slides along its curve for what depth moves in
    the picture, right and down: a usual face is turned either way, its curves drawn as they are
    seen, and its points looked for on them."""
    features = usual_features()
    lenses = np.concatenate([features, usual_lenses()["mouth"][None]])
    edges = [lifted(curve(lenses, _SAMPLES), features) for curve in (upper_curve, lower_curve)]
    points = lifted(places(lenses), features)
    slides = np.empty((len(POINTS), 2))
    for axis in range(2):
        ahead, back = (_seen_at(points, edges, axis, sine) for sine in (_TRIAL, -_TRIAL))
        slides[:, axis] = (ahead - back) / (2.0 * _TRIAL)
    slides[_ENDS] = 0.0
    return slides


def _seen_at(points: Array, edges: list[Array], axis: int, sine: float) -> Array:
    """(P,) the parameters at which ``points`` (P, 3) are seen on curves through ``edges`` (two of
    L + 1, S, 3), where depth moves along ``axis`` by ``sine``."""
    turn = np.eye(3)[:2]
    turn[axis, axis], turn[axis, 2] = np.sqrt(1.0 - sine**2), sine
    upper, lower = (edge @ turn.T for edge in edges)
    curves = _curves(np.stack([fit_lens(*pair) for pair in zip(upper, lower, strict=True)]))
    samples = np.linspace(0.0, 1.0, _SAMPLES)
    drawn = np.einsum("sc,pcx->psx", bernstein(samples), curves)
    chord = curves[:, -1] - curves[:, 0]
    away = ((drawn - (points @ turn.T)[:, None]) * chord[:, None]).sum(axis=-1)
    return np.asarray(samples[np.abs(away).argmin(axis=1)])


def depths(generic: Character) -> Array:
    """(P,) mm, head frame z, of the points on the generic face at a pupil distance of
    PUPIL_DISTANCE."""
    face = generic.face
    eyes = face.pivots
    scale = PUPIL_DISTANCE / float(np.linalg.norm(eyes["eye_left"] - eyes["eye_right"]))
    return np.asarray(face.points.at(face.vertices)[face.points.index(POINTS), 2] * scale)
