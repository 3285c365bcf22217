"""Feature points on the curves: the 20 of [B] (N = 60 coordinates) as FDP ids."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.curves.features import MOUTH, ROW, usual_features, usual_lenses
from mien.capture.snakes.curves.lens import LOWER, UPPER
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
_FARTHEST = 0.25
"""Of the parameter by which a turn may move a point along its curve."""


def places(lenses: Array, turn: Array | None = None) -> Array:
    """(P, 2) feature points on lenses (L + 1, 6, 2), in their units.

    A curve is known across and hardly along. Where along it a point lies, the head's ``turn``
    (3, 3, x right, y down, z away) says: of a mouth that is seen from the side, the far half is
    short.
    """
    share = bernstein(_AT if turn is None else _AT + _slid(turn))
    curves = lenses[_LENS][:, np.stack([UPPER, LOWER])]
    return np.asarray(np.einsum("pc,pe,pecx->px", share, _EDGE, curves))


def _slid(turn: Array) -> Array:
    """(P,) by how much of its chord each point of a resting face slides along it."""
    points, ends = _resting()
    return np.clip(
        _shares(points, ends, turn) - _shares(points, ends, np.eye(3)), -_FARTHEST, _FARTHEST
    )


def _shares(points: Array, ends: Array, turn: Array) -> Array:
    """(P,) shares of the chord between ``ends`` (P, 2, 3) at which ``points`` (P, 3) are seen."""
    seen, (first, last) = points @ turn[:2].T, np.moveaxis(ends @ turn[:2].T, 1, 0)
    chord = last - first
    return np.asarray(((seen - first) * chord).sum(axis=1) / (chord**2).sum(axis=1))


@cache
def _resting() -> tuple[Array, Array]:
    """(P, 3) the points and (P, 2, 3) the ends of their curves on a usual face, patch units."""
    usual = np.concatenate([usual_features(), usual_lenses()["mouth"][None]])
    return lifted(places(usual)), lifted(usual[_LENS, :2])


def depths(generic: Character) -> Array:
    """(P,) mm, head frame z, of the points on the generic face at a pupil distance of
    PUPIL_DISTANCE."""
    face = generic.face
    eyes = face.pivots
    scale = PUPIL_DISTANCE / float(np.linalg.norm(eyes["eye_left"] - eyes["eye_right"]))
    return np.asarray(face.points.at(face.vertices)[face.points.index(POINTS), 2] * scale)
