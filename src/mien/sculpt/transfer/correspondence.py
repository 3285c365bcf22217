"""Which place of one face answers to which of another.

The source is brought to the target by one similarity and a radial warp through the feature points
both have, then fitted to its surface without rigidity: closest places and the thin plate take
turns, the plate ever softer. Lids, sockets and the mouth's bag have no part in the fit (their
closest places are their neighbours'): the plate carries them along.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from mien.errors import InputError
from mien.face.face import Array, Face, Ints
from mien.numeric import rbf
from mien.numeric.biharmonic import Handles, spread, uniform_laplacian
from mien.numeric.facing import ClosestPoints
from mien.numeric.normals import vertex_normals
from mien.numeric.procrustes import Similarity, align
from mien.sculpt.transfer.outside import outside
from mien.sculpt.transfer.skin import Skin, on_skin

_FEWEST = 8

_NEIGHBOURS = 8
_STRAY = 8.0
"""mm by which a point may go elsewhere than its neighbours."""
_SMOOTHING = 0.03
"""Of the radial warp, in the unit of ``rbf.fit``: about 2 mm on a head."""
_SURROUNDINGS = 15.0
"""mm about a place over which the warp's stretch is measured ..."""
_STRETCH = (0.05, 20.0)
"""... and kept within, by volume."""
_BELIEF = 0.5
_PLATE = (30.0, 10.0, 3.0, 1.5)
"""How firm the plate is in each round of the fit, against one closest place a vertex."""
_STIFFNESS = 0.01
_LOOSE = 1e-6
"""Weight that keeps what nothing draws in its place."""
_TURNED = 18.0
"""mm by which a place that faces the other way counts as farther."""
_FAR = 25.0
"""mm beyond which no place answers."""
_LID = 1.45
"""Radii of an eyeball about its centre in which skin counts as lid."""


@dataclass(frozen=True, slots=True)
class Correspondence:
    """Source skin of S vertices laid on a target skin of V vertices."""

    similarity: Similarity
    """Brings the source to the target's place and size."""
    scale: Array
    """(S,) how much longer motion is on the target than at each vertex of the source. Its
    direction stays: both faces are in the head frame."""
    warped: Array
    """(S, 3) the source's vertices on the target, mm in the target's head frame."""
    partner: sparse.csr_matrix
    """(V, S) takes values at the source's vertices to the target's."""
    distance: Array
    """(V,) mm from a vertex to its partner on the warped source."""
    trust: Array
    """(V,) 0..1."""


def shared_points(source: Face, target: Face) -> tuple[str, ...]:
    """FDP ids on the skin of both. Raises InputError where they are too few."""
    common = tuple(fdp for fdp in source.points.ids if fdp in target.points.ids and on_skin(fdp))
    if len(common) < _FEWEST:
        raise InputError(
            f"only {len(common)} feature points are known on this face; give at least {_FEWEST}"
            " (eye corners, mouth corners, nose, lips, chin)"
        )
    return common


def correspond(source: Face, target: Face, skin: Skin, own: Skin) -> Correspondence:
    """Lay ``source``, whose skin is ``skin``, on ``target``, whose skin is ``own``. Raises
    InputError where they share too few points."""
    common = shared_points(source, target)
    from_places, to_places = _places(source, skin, common), _places(target, own, common)
    similarity = align(from_places, to_places)
    good = _agreeing(similarity(from_places), to_places)
    similarity = align(from_places[good], to_places[good])
    places = similarity(from_places[good])
    field = rbf.fit(places, to_places[good] - places, smoothing=_SMOOTHING)
    rest = similarity(skin.vertices)
    scale = similarity.scale * _local_scale(field, rest)
    seen = outside(rest, skin.triangles) & ~_lids(source, rest, similarity)
    warped = _fit(rest + field(rest), skin.triangles, seen, own)
    return _partners(similarity, scale, warped, skin.triangles, own)


def _places(face: Face, skin: Skin, ids: tuple[str, ...]) -> Array:
    """(P, 3) of feature points; those on lashes are taken to the skin behind, which looks ahead."""
    rows = face.points.index(ids)
    places = face.points.at(face.vertices)[rows]
    off = ~np.isin(face.points.vertices[rows], skin.rows).all(axis=1)
    if off.any():
        ahead = np.tile([0.0, 0.0, 1.0], (int(off.sum()), 1))
        found = ClosestPoints(skin.vertices, skin.triangles)(places[off], ahead, _TURNED)
        places[off] = found.matrix(skin.triangles, len(skin.vertices)) @ skin.vertices
    return places


def _local_scale(field: rbf.Field, places: Array) -> Array:
    """(S,) by how much the warp stretches the surroundings of ``places``, half believed: between
    two people motion does not grow with the face, between kinds of animals it does."""
    rows = []
    for axis in np.eye(3):
        step = _SURROUNDINGS * axis
        rows.append(axis + (field(places + step) - field(places - step)) / (2 * _SURROUNDINGS))
    volume = np.linalg.det(np.stack(rows, axis=1)).clip(*_STRETCH)
    return np.asarray(np.cbrt(volume) ** _BELIEF)


def _agreeing(places: Array, to_places: Array) -> NDArray[np.bool_]:
    """(P,) points that go about where their neighbours go: detectors err on bare skin."""
    shift = to_places - places
    near = np.argsort(np.linalg.norm(places[:, None] - places[None], axis=-1), axis=1)
    expected = np.median(shift[near[:, 1 : 1 + _NEIGHBOURS]], axis=1)
    return np.asarray(np.linalg.norm(shift - expected, axis=1) < _STRAY)


def _lids(face: Face, rest: Array, similarity: Similarity) -> NDArray[np.bool_]:
    """(S,) skin so near an eyeball that it is lid."""
    near = np.zeros(len(rest), dtype=bool)
    for eye in ("eye_left", "eye_right"):
        radius = eye_radius(face, eye) * similarity.scale
        distance = np.linalg.norm(rest - similarity(face.pivots[eye]), axis=1)
        near |= distance < _LID * radius
    return near


def eye_radius(face: Face, eye: str) -> float:
    """mm from the eye's pivot to the farthest of what turns with it; a fifth of the distance of
    the eyes where nothing does."""
    runs = [face.vertices[part.first : part.last] for part in face.parts if part.follows == eye]
    if not runs:
        apart = np.linalg.norm(face.pivots["eye_left"] - face.pivots["eye_right"])
        return float(0.2 * apart)
    return float(np.linalg.norm(np.concatenate(runs) - face.pivots[eye], axis=1).max())


def _fit(warped: Array, triangles: Ints, seen: NDArray[np.bool_], own: Skin) -> Array:
    """``warped`` (S, 3) drawn onto the target's skin where it is ``seen``, square to that skin:
    along it the feature points know better than closest places."""
    laplacian = uniform_laplacian(triangles.astype(np.intp), len(warped))
    target = ClosestPoints(own.vertices, own.triangles)
    own_normals = vertex_normals(own.vertices, own.triangles)
    rows = np.flatnonzero(seen)
    for firmness in _PLATE:
        normals = vertex_normals(warped, triangles)[rows]
        found = target(warped[rows], normals, _TURNED)
        reached = (found.distance < _FAR) & (found.facing > 0.0)
        at = found.matrix(own.triangles, len(own.vertices))
        square = at @ own_normals
        square /= np.maximum(np.linalg.norm(square, axis=1, keepdims=True), 1e-9)
        height = ((at @ own.vertices - warped[rows]) * square).sum(axis=1, keepdims=True)
        handles = Handles(len(warped))
        handles.add(rows[reached], (height * square)[reached], 1.0 / firmness)
        handles.hold(np.arange(len(warped)), _LOOSE)
        warped = warped + spread(laplacian, handles, _STIFFNESS)
    return warped


def _partners(
    similarity: Similarity, scale: Array, warped: Array, triangles: Ints, own: Skin
) -> Correspondence:
    normals = vertex_normals(own.vertices, own.triangles)
    found = ClosestPoints(warped, triangles)(own.vertices, normals, _TURNED)
    partner = found.matrix(triangles, len(warped))
    middle = float(np.median(np.minimum(found.distance, _FAR)))
    near = np.exp(-((found.distance / (3.0 + 2.0 * middle)) ** 2))
    trust = near * np.clip(0.5 + found.facing, 0.0, 1.0)
    return Correspondence(similarity, scale, warped, partner, found.distance, trust)
