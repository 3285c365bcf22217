"""How deep a face is: the generic face's skin under each place of the patch."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from mien.capture.snakes.curves.features import ROW
from mien.face.library import generic_face
from mien.vocabulary.landmarks import EYE_CORNERS

Array = NDArray[np.float64]


_BESIDE, _BEHIND = 4.0, 10.0
"""Patch units: skin that lies so near beside and so far behind other skin is inside the mouth or
the nose."""
_NOSTRILS = [ROW["nostril_right"], ROW["nostril_left"]]


def lifted(places: Array, features: Array) -> Array:
    """(..., 3) patch units with depth: x right, y down, z away from the viewer, zero at the eyes'
    corners; ``places`` (..., 2) of the resting face that has ``features`` (L, 6, 2).

    The generic face is stretched until its nostrils and its mouth are as far below the eyes.
    """
    flat, depth = _skin()
    nostrils = features[_NOSTRILS].mean(axis=(0, 1))[1]
    mouth = features[ROW["lips"], :2].mean(axis=0)[1]
    own, generic = [0.0, nostrils, mouth], [0.0, *_heights()]
    x, y = places[..., 0], places[..., 1]
    down = np.interp(y, own, generic) + np.minimum(y, 0.0) + np.maximum(y - mouth, 0.0)
    stretched = np.stack([x, down], axis=-1)
    nearest = ((stretched[..., None, :] - flat) ** 2).sum(-1).argmin(-1)
    return np.concatenate([places, depth[nearest][..., None]], axis=-1)


@cache
def _skin() -> tuple[Array, Array]:
    """(V, 2) and (V,) the front of the generic face in patch units, as it is seen."""
    face = generic_face().face
    skin = face.part("skin")
    places = _in_patch(face.vertices[skin.first : skin.last])
    front = places[places[:, 2] < 10.0]
    pairs = cKDTree(front[:, :2]).query_pairs(_BESIDE, output_type="ndarray")
    behind = front[pairs[:, 0], 2] - front[pairs[:, 1], 2]
    hidden = np.where(behind > 0.0, pairs[:, 0], pairs[:, 1])[np.abs(behind) > _BEHIND]
    front = np.delete(front, hidden, axis=0)
    return front[:, :2], front[:, 2]


@cache
def _heights() -> tuple[float, float]:
    """How far below the eyes the generic face has its nostrils and the mouth's corners, patch
    units; nostrils lie midway between the wings of the nose (9.1, 9.2) and its base (9.15)."""
    face = generic_face().face
    points = face.points.at(face.vertices)
    wings, base, corners = (
        float(_in_patch(points[face.points.index(names)])[:, 1].mean())
        for names in (("9.1", "9.2"), ("9.15",), ("8.3", "8.4"))
    )
    return 0.5 * (wings + base), corners


def _in_patch(vertices: Array) -> Array:
    """(..., 3) patch units, x right, y down, z away, of the generic face's own mm."""
    corners = generic_face().face.vertices[np.array(EYE_CORNERS)].mean(axis=1)
    scale = 100.0 / float(corners[0, 0] - corners[1, 0])
    return np.asarray((vertices - corners.mean(axis=0)) * scale * np.array([1.0, -1.0, -1.0]))
