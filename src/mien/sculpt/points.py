"""Where the 84 MPEG-4 feature points lie on a sculpted head."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from mien.face.face import FeaturePoints, Ints, Part
from mien.sculpt.anatomy.cage import cage
from mien.vocabulary import fdp, landmarks

Array = NDArray[np.float64]

SILHOUETTE: Mapping[str, int] = {"2.11": 400, "2.12": 176, "2.13": 397, "2.14": 172}
"""Corners of chin and jaw: the detector's slide over the skin, but on the mesh they are places."""

_NECK_AXIS = (234, 454), 0.4
"""7.1, the top of the spine, lies two fifths from either temple towards the back of the head."""
_MEETS = 5.0
"""mm between skin and hair where one ends and the other begins."""


class _Places:
    """Vertices of a character by part."""

    def __init__(self, vertices: Array, parts: tuple[Part, ...]) -> None:
        self.vertices = vertices
        self.parts = {part.name: part for part in parts}

    def best(self, part: str, score: ArrayLike) -> int:
        """Vertex of ``part`` with the highest score."""
        return self.parts[part].first + int(np.argmax(score))

    def of(self, part: str) -> Array:
        chosen = self.parts[part]
        return self.vertices[chosen.first : chosen.last]

    def nearest(self, part: str, place: ArrayLike) -> int:
        return self.best(part, -np.linalg.norm(self.of(part) - np.asarray(place), axis=1))


def feature_points(vertices: Array, parts: tuple[Part, ...]) -> FeaturePoints:
    """All 84 points on a mesh in the head frame whose first part is the sculpted skin."""
    places = _Places(vertices, parts)
    found = {**landmarks.feature_points(), **SILHOUETTE, **_mouth_points(places)}
    for point, side in (("3.5", "left"), ("3.6", "right")):
        # An eye begins with the middle of its pupil.
        found[point] = places.parts[f"eye_{side}"].first
    found |= _ear_points(places)
    found |= _skull_points(places)
    ids = tuple(fdp.feature_points())
    corners, weights = np.zeros((len(ids), 3), np.int32), np.zeros((len(ids), 3))
    faces = {part.name: part.triangles for part in parts}
    for row, point in enumerate(ids):
        if point == "7.1":
            temples, share = _NECK_AXIS
            corners[row] = [*temples, found["11.6"]]
            weights[row] = [share, share, 1 - 2 * share]
        else:
            corners[row] = _triangle_at(found[point], parts, faces)
            weights[row, 0] = 1.0
    return FeaturePoints(ids, corners, weights)


def _triangle_at(vertex: int, parts: tuple[Part, ...], faces: Mapping[str, Ints]) -> list[int]:
    """A triangle that has ``vertex``, turned so that it comes first."""
    owner = next(part for part in parts if part.first <= vertex < part.last)
    triangles = faces[owner.name]
    row, corner = np.argwhere(triangles == vertex)[0]
    return list(np.roll(triangles[row], -corner))


def _mouth_points(places: _Places) -> dict[str, int]:
    tongue = places.of("tongue")
    middle = tongue.mean(axis=0)
    top = tongue[:, 1] - 9 * np.abs(tongue[:, 0]) - 0.5 * np.abs(tongue[:, 2] - middle[2])
    found = {
        "6.1": places.best("tongue", tongue[:, 2]),
        "6.2": places.best("tongue", top),
        "6.3": places.best("tongue", tongue[:, 0]),
        "6.4": places.best("tongue", -tongue[:, 0]),
    }
    for point, part, sign in (
        ("9.8", "teeth_upper", 1),
        ("9.9", "teeth_lower", -1),
        ("9.10", "teeth_upper", -1),
        ("9.11", "teeth_lower", 1),
    ):
        if part in places.parts:
            row = places.of(part)
            score = sign * row[:, 1] - 3 * np.abs(row[:, 0]) + 0.3 * row[:, 2]
            found[point] = places.best(part, score)
        else:
            # No teeth: where they would be, on the mouth bag.
            lip = cage().bag[1, 5] if part == "teeth_upper" else cage().bag[1, 15]
            found[point] = int(lip)
    return found


def _ear_points(places: _Places) -> dict[str, int]:
    found: dict[str, int] = {}
    for side, odd, sign in (("left", 0, 1), ("right", 1, -1)):
        part = f"ear_{side}"
        name = {what: f"10.{number + odd}" for what, number in _EAR_NUMBERS.items()}
        if part in places.parts:
            ear = places.of(part)
            top, bottom = ear[:, 1].max(), ear[:, 1].min()
            level = np.abs(ear[:, 1] - (top + bottom) / 2)
            found[name["top"]] = places.best(part, ear[:, 1])
            found[name["back"]] = places.best(part, -ear[:, 2] - level)
            found[name["lobe"]] = places.best(part, -ear[:, 1])
            front = ear[:, 2].max()
            low, high = bottom + 0.15 * (top - bottom), bottom + 0.75 * (top - bottom)
            x = sign * np.abs(ear[:, 0]).min()
        else:
            temple = places.vertices[454 if sign > 0 else 234]
            x, front, low, high = temple[0], temple[2] - 5, temple[1] - 20, temple[1] + 12
            found[name["top"]] = places.nearest("skin", (x, high, front - 15))
            found[name["back"]] = places.nearest("skin", (x, (low + high) / 2, front - 22))
            found[name["lobe"]] = places.nearest("skin", (x, low, front - 12))
        found[name["lower"]] = places.nearest("skin", (x, low, front))
        found[name["upper"]] = places.nearest("skin", (x, high, front))
    return found


_EAR_NUMBERS = {"top": 1, "back": 3, "lobe": 5, "lower": 7, "upper": 9}


def _skull_points(places: _Places) -> dict[str, int]:
    skin = places.of("skin")
    midline = np.where(np.abs(skin[:, 0]) < 0.5, 0.0, -1e3)
    top = int(np.argmax(skin[:, 1] + midline))
    above = top
    if "hair" in places.parts:
        hair = places.of("hair") - skin[top]
        above = places.best("hair", hair[:, 1] - 4 * np.abs(hair[:, 0]) - 0.5 * np.abs(hair[:, 2]))
    back = int(np.argmax(-skin[:, 2] - 3 * np.abs(skin[:, 1]) + midline))
    found = {"11.4": top, "11.5": above, "11.6": back}
    found["11.1"] = _hair_line(places, 10, 0.5)
    found["11.3"] = _hair_line(places, 284, 6.0)
    found["11.2"] = int(cage().fine_mirror[found["11.3"]])
    return found


def _hair_line(places: _Places, landmark: int, width: float) -> int:
    """Where hair of either side meets the skin within ``width`` of ``landmark``'s x; the landmark
    where there is no hair."""
    if "hair" not in places.parts:
        return landmark
    skin, hair = places.of("skin"), places.of("hair")
    start = skin[landmark]
    column = np.flatnonzero(
        (np.abs(skin[:, 0] - start[0]) < width)
        & (skin[:, 1] > max(start[1] - 40, 20))
        & (skin[:, 2] > -60)
    )
    apart, _ = cKDTree(np.vstack([hair, hair * [-1, 1, 1]])).query(skin[column])
    met = column[apart < _MEETS]
    return int(met[np.argmin(skin[met, 1])]) if len(met) else landmark
