"""Feature points on the curves: the 20 of [B] (N = 60 coordinates) as FDP ids, and the rigid ones
that tell how the head is turned."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from mien.capture.headfit import HeadModel
from mien.capture.snakes.features import MOUTH, ROW
from mien.capture.snakes.flow import COUNT as RIGID, _GRID as GRID
from mien.capture.snakes.lens import LOWER, UPPER
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
_CORNERS: dict[str, tuple[int, str, float]] = {
    "3.7": (ROW["eye_left"], BOTH, 1.0),
    "3.11": (ROW["eye_left"], BOTH, 0.0),
    "3.8": (ROW["eye_right"], BOTH, 1.0),
    "3.12": (ROW["eye_right"], BOTH, 0.0),
}
"""Eye corners, which stay with the bone."""


def _weights() -> Array:
    rows = []
    for lens, edge, at in (*_PLACES.values(), *_CORNERS.values()):
        row = np.zeros((MOUTH + 1, 6))
        share = bernstein(np.array([at]))[0]
        for control, used in ((UPPER, edge != DOWN), (LOWER, edge != UP)):
            row[lens, control] += used * share / (2.0 if edge == BOTH else 1.0)
        rows.append(row)
    return np.stack(rows)


_WEIGHTS = _weights()
"""(24, L, 6): points are linear in the lenses."""

COUNT = len(_WEIGHTS) + RIGID


def places(lenses: Array, rigid: Array) -> Array:
    """(..., N, 2) feature points, eye corners and rigid points of lenses (..., L, 6, 2) and rigid
    points (..., G, 2), in their units."""
    return np.concatenate([np.einsum("nlc,...lcx->...nx", _WEIGHTS, lenses), rigid], axis=-2)


@dataclass(frozen=True, slots=True)
class Relief:
    """What the generic face says of the points: how deep they lie and how they may move."""

    depth: Array
    """(N,) mm, head frame z, at the size of the performer."""
    shapes: Array
    """(K, N, 3) mm."""


@cache
def _names() -> tuple[str, ...]:
    return (*_PLACES, *_CORNERS)


def relief(generic: Character) -> Relief:
    """Of the generic face, at a pupil distance of PUPIL_DISTANCE."""
    face = generic.face
    eyes = face.pivots
    scale = PUPIL_DISTANCE / float(np.linalg.norm(eyes["eye_left"] - eyes["eye_right"]))
    skin = face.part("skin")
    places = face.vertices[skin.first : skin.last] * scale
    front = np.flatnonzero(places[:, 2] > 0.0)
    flat = GRID * np.array([MM, -MM])
    nearest = [
        skin.first + int(front[((places[front, :2] - place) ** 2).sum(1).argmin()])
        for place in flat
    ]
    rows = [generic.keys.names.index(name) for name in generic.examples]
    fields = generic.keys.displacements[rows].astype(float)
    marked = face.points.index(_names())
    depth = np.concatenate([face.points.at(face.vertices)[marked, 2], face.vertices[nearest, 2]])
    shapes = np.concatenate([face.points.at(fields)[:, marked], fields[:, nearest]], axis=1)
    return Relief(depth * scale, shapes * scale)


def head_model(neutral: Array, known: Relief) -> HeadModel:
    """What is fitted to a frame: the performer's points at rest (N, 3) mm and the generic shapes."""
    return HeadModel(neutral, known.shapes, np.arange(len(_PLACES), COUNT))
