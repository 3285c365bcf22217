"""What beside the skin moves with it: the lower jaw's teeth and the tongue as the source's do,
brows and lashes by the skin they sit on; eyes, the upper teeth and all else stay."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from mien.face.character import Character
from mien.face.face import Array, Face
from mien.numeric.facing import ClosestPoints
from mien.numeric.procrustes import Similarity, align
from mien.sculpt.transfer.skin import Index, Skin, pieces_beside

LOWER_TEETH = "teeth_lower"
_BEHIND = 2.0
"""mm behind the lips at which the inside of the mouth begins ..."""
_DEPTH = 80.0
"""... and ends, on a face with a mouth 50 mm wide."""
_RIDES = 6.0
"""mm from the skin within which a whole piece sits on it: lashes, brows, a moustache."""
_ROOTED = 1.0
"""mm from the skin at which a longer piece has its roots, and goes with them ..."""
_LONGEST = 15.0
"""... if it is no longer than lashes are."""
_LIPS = frozenset({"2.2", "2.3", "8.3", "8.4"})


def move_parts(
    face: Face,
    skin: Skin,
    motion: Array,
    source: Character,
    shapes: tuple[str, ...],
    similarity: Similarity,
) -> Array:
    """(K, V, 3) motion of the whole face in ``shapes`` (K) of ``source`` from ``motion``
    (K, N, 3) of its skin; ``similarity`` brings the source to the face."""
    whole = skin.spread(motion, len(face.vertices))
    surface = ClosestPoints(skin.vertices, skin.triangles)
    for rows in pieces_beside(face, skin):
        if _in_mouth(face, rows):
            if _is_lower(face, rows):
                places = face.vertices[rows]
                whole[:, rows] = _with_jaw(face, source, shapes, similarity, places)
            continue
        found = surface(face.vertices[rows])
        if found.distance.max() < _RIDES:
            at = found.matrix(skin.triangles, len(skin.vertices))
            whole[:, rows] = np.stack([at @ field for field in motion])
        elif found.distance.min() < _ROOTED and found.distance.max() < _LONGEST:
            roots = np.flatnonzero(found.distance < _ROOTED)
            _, nearest = cKDTree(face.vertices[rows[roots]]).query(face.vertices[rows])
            at = found.matrix(skin.triangles, len(skin.vertices))[roots[nearest]]
            whole[:, rows] = np.stack([at @ field for field in motion])
    return whole


def _in_mouth(face: Face, rows: Index) -> bool:
    if not set(face.points.ids) >= _LIPS:
        return False
    middle, width = _mouth(face)
    away = face.vertices[rows].mean(axis=0) - middle
    size = width / 50.0
    behind = -_DEPTH * size < away[2] < -_BEHIND * size
    return bool(abs(away[0]) < 0.6 * width and abs(away[1]) < 0.6 * width and behind)


def _mouth(face: Face) -> tuple[Array, float]:
    """Middle of the mouth and its width."""
    middle = (face.point("2.2") + face.point("2.3")) / 2.0
    return middle, float(np.linalg.norm(face.point("8.3") - face.point("8.4")))


def _is_lower(face: Face, rows: Index) -> bool:
    """Whether a piece of the mouth hangs on the lower jaw. Where a part's name says so, it is
    believed."""
    for part in face.parts:
        if part.first <= rows[0] < part.last:
            name = part.name.lower()
            if "upper" in name or "lower" in name:
                return "lower" in name
    middle, _ = _mouth(face)
    return bool(face.vertices[rows, 1].mean() < middle[1])


def _with_jaw(
    face: Face,
    source: Character,
    shapes: tuple[str, ...],
    similarity: Similarity,
    places: Array,
) -> Array:
    """(K, n, 3) motion of ``places`` that turn about this face's jaw as the source's lower teeth
    turn about its own."""
    motion = np.zeros((len(shapes), *places.shape))
    if not any(part.name == LOWER_TEETH for part in source.face.parts):
        return motion
    part = source.face.part(LOWER_TEETH)
    teeth, hinge = source.face.vertices[part.first : part.last], source.face.pivots["jaw"]
    for k, shape in enumerate(shapes):
        moved = source.keys[shape][part.first : part.last]
        if not moved.any():
            continue
        jaw = align(teeth - hinge, teeth + moved - hinge)
        turn = similarity.rotation @ jaw.rotation @ similarity.rotation.T
        shift = similarity.scale * similarity.rotation @ jaw.shift
        own = places - face.pivots["jaw"]
        motion[k] = own @ turn.T - own + shift
    return motion
