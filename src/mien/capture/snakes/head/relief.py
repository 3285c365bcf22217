"""How deep a face is: the generic face's skin under each place of the patch."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from mien.face.library import generic_face
from mien.vocabulary.landmarks import EYE_CORNERS

Array = NDArray[np.float64]


def lifted(places: Array) -> Array:
    """(..., 3) patch units with depth: x right, y down, z away from the viewer, zero at the eyes'
    corners; ``places`` (..., 2) of a resting face."""
    flat, depth = _skin()
    nearest = ((places[..., None, :] - flat) ** 2).sum(-1).argmin(-1)
    return np.concatenate([places, depth[nearest][..., None]], axis=-1)


@cache
def _skin() -> tuple[Array, Array]:
    """(V, 2) and (V,) the front of the generic face in patch units."""
    face = generic_face().face
    corners = face.vertices[np.array(EYE_CORNERS)].mean(axis=1)
    scale = 100.0 / float(corners[0, 0] - corners[1, 0])
    skin = face.part("skin")
    places = (face.vertices[skin.first : skin.last] - corners.mean(axis=0)) * scale
    front = places[places[:, 2] > -10.0]
    return front[:, :2] * np.array([1.0, -1.0]), -front[:, 2]
