"""How the skin follows each FAP: influence maps, the jaw's share, the two edges of the lips.

A point is in the way of another's influence only along the axes in which some FAP moves it: lips
that are pushed forward at the middle come forward as a whole, for no FAP says how far their
quarters come.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from mien.face.face import Array, Face
from mien.face.influence import LIPS, Mask, Opening, Surface, along_the_skin, opening, part_of
from mien.vocabulary.fap import simple

Index = NDArray[np.intp]

OUTER_LIPS = ("8.3", "8.5", "8.1", "8.6", "8.4", "8.8", "8.2", "8.7")
_OUTER_OF = {"2.2": "8.1", "2.3": "8.2", "2.4": "8.3", "2.5": "8.4"} | {
    "2.6": "8.5", "2.7": "8.6", "2.8": "8.7", "2.9": "8.8"
}  # fmt: skip
"""Points at either edge of the lips. Close as they are, a map that is 1 at one and 0 at the other
would swing far beyond both; so the two share one map, split across the lip."""
_INNER_OF = {outer: inner for inner, outer in _OUTER_OF.items()}
CHIN = "2.1"
_ON_JAW = (CHIN, "2.10", "2.11", "2.12", "2.13", "2.14")
"""Skin over the lower jaw, which goes where the bone goes."""
_STILL = (
    *("3.7", "3.8", "3.11", "3.12", "9.6", "9.7", "9.12", "9.13", "9.14", "9.15"),
    *("10.7", "10.8", "10.9", "10.10", "11.1", "11.2", "11.3"),
)
"""What no FAP moves: corners of the eyes, bone of the nose, roots of the ears, hair line."""
_MOVABLE = {2, 3, 4, 5, 8, 9, 10}
"""Groups whose points lie on skin."""
_EYES = {"3.5", "3.6"}
_REACH, _JAW_REACH = 0.5, 1.6
"""Of the distance of the pupils."""
_RIM_REACH = 16.0
"""mm into the mouth over which its lining no longer follows the lips, on a face of usual size."""
_STEEP = 4.0
"""How fast the lining passes from the upper jaw to the lower, beside the corners of the mouth."""
_AXES = range(3)


@dataclass(frozen=True, slots=True)
class Skin:
    """What FAPs do to the skin, per mm of their own motion."""

    part: Mask
    """(V,) vertices that are skin."""
    maps: dict[tuple[str, int], Array]
    """(V,) influence of a point along an axis."""
    jaw: tuple[Array, Array, Array]
    """(V,) share of the jaw's motion along each axis."""
    lining: Mask
    """(V,) the mouth's inside, which hangs between ``rim`` and the jaws."""
    rim_share: Array
    """(V,) 1 where the lining follows the rim, 0 where it follows its jaw."""
    rim_near: tuple[Index, Array]
    """For every lining vertex the rim vertices (N, K) and weights (N, K) it follows."""
    floor: Array
    """(V,) 1 where the lining belongs to the lower jaw."""


def skin(face: Face, held: Mask) -> Skin:
    """The skin of ``face``; ``held`` (V,) vertices move with nothing but the lids."""
    owner = face.points.vertices[face.points.index([CHIN])[0], 0]
    part = part_of(face, int(owner))
    triangles = next(p for p in face.parts if p.first <= owner < p.last).triangles
    mouth = opening(face, LIPS)
    eyes = float(np.linalg.norm(face.pivots["eye_left"] - face.pivots["eye_right"]))
    outside = triangles[~mouth.inside[triangles].all(axis=1)]
    plate = Surface(face.vertices, outside, face.points, _REACH * eyes, held)
    broad = Surface(face.vertices, outside, face.points, _JAW_REACH * eyes, held)
    split = _across_the_lips(face, mouth)
    maps: dict[tuple[str, int], Array] = {}
    for axis in _AXES:
        maps |= _maps(face, plate, axis, split)
    jaw = tuple(_jaw(broad, axis) for axis in _AXES)
    lining = mouth.inside.copy()
    lining[outside] = False
    share, near, floor = _lining(face, mouth.rim, lining, eyes / 63.0)
    return Skin(part, maps, (jaw[0], jaw[1], jaw[2]), lining, share, near, floor)


def _moved(surface: Surface, axis: int) -> list[str]:
    """The points of ``surface`` that FAPs move along ``axis``."""
    points = dict.fromkeys(
        fap.point for fap in simple() if fap.axis == axis and fap.group in _MOVABLE
    )
    return [fdp for fdp in points if fdp in surface.ids and fdp not in _EYES]


def _maps(face: Face, surface: Surface, axis: int, split: Array) -> dict[tuple[str, int], Array]:
    """The maps of all points moved along ``axis``: 1 at their own, 0 at the others."""
    moved = [fdp for fdp in _moved(surface, axis) if fdp != CHIN]
    found = []
    for fdp in moved:
        partner = _OUTER_OF.get(fdp) or _INNER_OF.get(fdp)
        one = (fdp,) if partner is None else (fdp, partner)
        zero = [other for other in (*moved, CHIN, *_STILL) if other not in one]
        shared = surface.map(one, zero)
        if partner in moved:
            shared = shared * (1.0 - split if fdp in _OUTER_OF else split)
        found.append(shared)
    maps = np.array(found).reshape(len(moved), len(face.vertices))
    # Splitting is not quite exact where a point lies inside a triangle: this makes it so.
    at = face.points.at(np.repeat(maps[..., None], 3, axis=-1))[..., 0]
    exact = np.linalg.solve(at[:, face.points.index(moved)], maps)
    return {(fdp, axis): row for fdp, row in zip(moved, exact, strict=True)}


def _jaw(surface: Surface, axis: int) -> Array:
    still = [fdp for fdp in (*_moved(surface, axis), *_STILL) if fdp not in _ON_JAW]
    # Lips are dragged along as a whole or stay as a whole.
    still += [_OUTER_OF[fdp] for fdp in still if fdp in _OUTER_OF and _OUTER_OF[fdp] not in still]
    return surface.map(_ON_JAW, still)


def _across_the_lips(face: Face, mouth: Opening) -> Array:
    """(V,) 0 on the inner edge of the lips and inside, 1 on their outer edge and beyond."""
    contour = opening(face, OUTER_LIPS)
    inner, _ = cKDTree(face.vertices[mouth.rim]).query(face.vertices)
    outer, _ = cKDTree(face.vertices[contour.rim]).query(face.vertices)
    part = inner / np.maximum(inner + outer, 1e-9)
    smooth = part * part * (3.0 - 2.0 * part)
    lips = contour.inside & ~mouth.inside
    smooth = np.where(lips, smooth, 1.0)
    smooth[mouth.inside] = 0.0
    smooth[mouth.rim] = 0.0
    return np.asarray(smooth)


def _lining(
    face: Face, edge: Index, lining: Mask, size: float
) -> tuple[Array, tuple[Index, Array], Array]:
    """Lips that are shut lie on each other: which of them a vertex of the lining belongs to, only
    the way along the skin tells."""
    turn = int(np.argmin(np.linalg.norm(face.vertices[edge] - face.point(LIPS[4]), axis=1)))
    halves = edge[: turn + 1], np.append(edge[turn:], edge[0])
    above, below = (along_the_skin(face, half)[lining] for half in halves)
    part = np.clip((above / (above + below) - 0.5) * _STEEP + 0.5, 0.0, 1.0)
    near, weight = [], []
    for half, belongs in zip(halves, (1.0 - part, part), strict=True):
        distance, nearest = cKDTree(face.vertices[half]).query(face.vertices[lining], k=4)
        close = 1.0 / np.maximum(distance, 1e-6) ** 2
        near.append(half[nearest])
        weight.append(belongs[:, None] * close / close.sum(axis=1, keepdims=True))
    share, floor = np.zeros((2, len(face.vertices)))
    share[lining] = np.exp(-((np.minimum(above, below) / (_RIM_REACH * size)) ** 2))
    floor[lining] = part
    return share, (np.hstack(near), np.hstack(weight)), floor
