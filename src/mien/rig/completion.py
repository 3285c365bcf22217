"""All feature points of a face from a few: by symmetry, then by warping the generic face.

The generic face is brought to the picks by a smooth field, and what it carries is dropped onto the
skin. It is the way of last resort where nobody's network knows the face: a fox's, a dinosaur's.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array, FeaturePoints, Ints
from mien.face.library import generic_face
from mien.numeric.closest import nearest
from mien.numeric.rbf import fit
from mien.rig.picks import Picks
from mien.vocabulary.fdp import feature_points

_GROUPS = frozenset({2, 3, 4, 5, 8, 9})
_HARD = frozenset({"9.8", "9.9", "9.10", "9.11"})
_PUPILS = ("3.5", "3.6")
LIDS = (("3.7", "3.11", "3.1", "3.3"), ("3.12", "3.8", "3.2", "3.4"))
"""Outer and inner corner, upper and lower margin of the left and right eye."""
_QUARTERS = (
    *(("2.6", "8.5", "2.2", "8.1"), ("2.7", "8.6", "2.2", "8.1")),
    *(("2.8", "8.7", "2.3", "8.2"), ("2.9", "8.8", "2.3", "8.2")),
)
"""Inner and outer lip half-way to the corner, inner and outer lip in the middle."""
_TAPER = 0.7
"""Thickness of a lip half-way to the corner, of that in the middle."""
_FLIP = np.array([-1.0, 1.0, 1.0])
_SMOOTH = 1e-3


def mirrored(picks: Picks) -> dict[str, Array]:
    """``picks`` with their partners on the other side, in a frame whose x is 0 in the middle."""
    known = feature_points()
    whole = dict(picks)
    for name, place in picks.items():
        partner = known[name].mirror
        if partner not in picks:
            whole[partner] = place * _FLIP
    return whole


def balanced(picks: Picks) -> dict[str, Array]:
    """``picks`` with each pair at the mean of both sides: what was found by looking errs on each
    side by itself."""
    known = feature_points()
    flip = {name: picks.get(known[name].mirror, place) * _FLIP for name, place in picks.items()}
    return {name: (place + flip[name]) / 2.0 for name, place in picks.items()}


def warped(picks: Picks) -> tuple[dict[str, Array], dict[str, Array]]:
    """Places (3,) of all the feature points a face has on its skin, and of its pivots, before
    they are dropped onto it. ``picks`` in millimetres, upright, facing +z."""
    face = generic_face().face
    names = [name for name in picks if name in face.points.ids]
    ground = face.points.at(face.vertices)
    place = {name: ground[i] for i, name in enumerate(face.points.ids)}
    source = np.stack([place[name] for name in names])
    target = np.stack([picks[name] for name in names])
    scale = _spread(target) / _spread(source)
    shift = target.mean(axis=0) - scale * source.mean(axis=0)
    field = fit(scale * source + shift, target, smoothing=_SMOOTH)
    wanted = [
        name
        for name, point in feature_points().items()
        if point.group in _GROUPS and name not in _HARD and name in place
    ]
    moved = field(scale * np.stack([place[name] for name in wanted]) + shift)
    found = dict(zip(wanted, moved, strict=True)) | {n: picks[n] for n in names if n in wanted}
    for inner, outer, middle, edge in _QUARTERS:
        # The generic mouth is shut: both lips of an open one would be carried to one place.
        if inner not in picks:
            found[inner] = found[outer] + _TAPER * (found[middle] - found[edge])
    pivots = {name: scale * pivot + shift for name, pivot in face.pivots.items()}
    return found, pivots


def on_surface(places: dict[str, Array], vertices: Array, triangles: Ints) -> FeaturePoints:
    """``places`` as points of the nearest triangles."""
    triangle, weights = nearest(np.stack(list(places.values())), vertices, triangles)
    corners = triangles[triangle].astype(np.int32)
    return FeaturePoints(tuple(places), corners, weights / weights.sum(axis=1, keepdims=True))


def with_pupils(
    points: FeaturePoints, vertices: Array, triangles: Ints, balls: NDArray[np.bool_]
) -> FeaturePoints:
    """``points`` with the pupils on the eyeballs ``balls`` (V,)."""
    own = triangles[balls[triangles].all(axis=1)]
    rows, at = points.index(_PUPILS), points.at(vertices)
    middles = [at[points.index(lids)].mean(axis=0) for lids in LIDS]
    front = on_surface(dict(zip(_PUPILS, middles, strict=True)), vertices, own)
    corners, weights = points.vertices.copy(), points.weights.copy()
    corners[rows], weights[rows] = front.vertices, front.weights
    return FeaturePoints(points.ids, corners, weights)


def _spread(places: Array) -> float:
    return float(np.sqrt(((places - places.mean(axis=0)) ** 2).sum(axis=1).mean()))
