"""Feature points on the curves: the 20 of [B] (N = 60 coordinates) as FDP ids."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.curves.features import MOUTH, ROW
from mien.capture.snakes.curves.lens import LOWER, UPPER
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


def _weights() -> Array:
    rows = []
    for lens, edge, at in _PLACES.values():
        row = np.zeros((MOUTH + 1, 6))
        share = bernstein(np.array([at]))[0]
        for control, used in ((UPPER, edge != DOWN), (LOWER, edge != UP)):
            row[lens, control] += used * share / (2.0 if edge == BOTH else 1.0)
        rows.append(row)
    return np.stack(rows)


_WEIGHTS = _weights()
"""(P, L + 1, 6): points are linear in the lenses."""


def places(lenses: Array) -> Array:
    """(..., P, 2) feature points on lenses (..., L + 1, 6, 2), in their units."""
    return np.asarray(np.einsum("plc,...lcx->...px", _WEIGHTS, lenses))


def depths(generic: Character) -> Array:
    """(P,) mm, head frame z, of the points on the generic face at a pupil distance of
    PUPIL_DISTANCE."""
    face = generic.face
    eyes = face.pivots
    scale = PUPIL_DISTANCE / float(np.linalg.norm(eyes["eye_left"] - eyes["eye_right"]))
    return np.asarray(face.points.at(face.vertices)[face.points.index(POINTS), 2] * scale)
