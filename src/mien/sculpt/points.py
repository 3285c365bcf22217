"""Where the 84 MPEG-4 feature points lie on a sculpted head."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mien.face.face import FeaturePoints, Ints, Part
from mien.sculpt.cage import AROUND, cage

Array = NDArray[np.float64]

LANDMARKS: Mapping[str, int] = {
    "2.1": 152, "2.2": 13, "2.3": 14, "2.4": 308, "2.5": 78, "2.6": 311, "2.7": 81,
    "2.8": 402, "2.9": 178, "2.10": 199, "2.11": 400, "2.12": 176, "2.13": 397, "2.14": 172,
    "3.1": 386, "3.2": 159, "3.3": 374, "3.4": 145, "3.7": 263, "3.8": 133, "3.9": 253,
    "3.10": 23, "3.11": 362, "3.12": 33, "3.13": 257, "3.14": 27,
    "4.1": 285, "4.2": 55, "4.3": 334, "4.4": 105, "4.5": 300, "4.6": 70,
    "5.1": 434, "5.2": 214, "5.3": 330, "5.4": 101,
    "8.1": 0, "8.2": 17, "8.3": 291, "8.4": 61, "8.5": 269, "8.6": 39, "8.7": 405,
    "8.8": 181, "8.9": 37, "8.10": 267,
    "9.1": 358, "9.2": 129, "9.3": 4, "9.4": 98, "9.5": 327, "9.6": 193, "9.7": 417,
    "9.12": 195, "9.13": 248, "9.14": 3, "9.15": 2,
}  # fmt: skip
"""Points that are landmarks, and so skin vertices."""

IDS = tuple(
    f"{group}.{number}"
    for group, count in (
        (2, 14),
        (3, 14),
        (4, 6),
        (5, 4),
        (6, 4),
        (7, 1),
        (8, 10),
        (9, 15),
        (10, 10),
        (11, 6),
    )
    for number in range(1, count + 1)
)

_NECK_AXIS = (234, 454), 0.4
"""7.1, the top of the spine, lies two fifths from either temple towards the back of the head."""


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


def feature_points(
    vertices: Array, parts: tuple[Part, ...], pivots: Mapping[str, Array]
) -> FeaturePoints:
    """All 84 points on a mesh in the head frame whose first part is the sculpted skin."""
    places = _Places(vertices, parts)
    found = dict(LANDMARKS)
    found |= _mouth_points(places, vertices)
    for fdp, side in (("3.5", "left"), ("3.6", "right")):
        ahead = pivots[f"eye_{side}"] + [0, 0, 100.0]
        found[fdp] = places.nearest(f"eye_{side}", ahead)
    found |= _ear_points(places)
    found |= _skull_points(places)
    corners, weights = np.zeros((len(IDS), 3), np.int32), np.zeros((len(IDS), 3))
    faces = {part.name: part.triangles for part in parts}
    for row, fdp in enumerate(IDS):
        if fdp == "7.1":
            temples, share = _NECK_AXIS
            corners[row] = [*temples, found["11.6"]]
            weights[row] = [share, share, 1 - 2 * share]
        else:
            corners[row] = _triangle_at(found[fdp], parts, faces)
            weights[row, 0] = 1.0
    return FeaturePoints(IDS, corners, weights)


def _triangle_at(vertex: int, parts: tuple[Part, ...], faces: Mapping[str, Ints]) -> list[int]:
    """A triangle that has ``vertex``, turned so that it comes first."""
    owner = next(part for part in parts if part.first <= vertex < part.last)
    triangles = faces[owner.name]
    row, corner = np.argwhere(triangles == vertex)[0]
    return list(np.roll(triangles[row], -corner))


def _mouth_points(places: _Places, vertices: Array) -> dict[str, int]:
    tongue = places.of("tongue")
    middle = tongue.mean(axis=0)
    top = tongue[:, 1] - 2 * np.abs(tongue[:, 0]) - 0.5 * np.abs(tongue[:, 2] - middle[2])
    found = {
        "6.1": places.best("tongue", tongue[:, 2]),
        "6.2": places.best("tongue", top),
        "6.3": places.best("tongue", tongue[:, 0]),
        "6.4": places.best("tongue", -tongue[:, 0]),
    }
    for fdp, part, sign in (
        ("9.8", "teeth_upper", 1),
        ("9.9", "teeth_lower", -1),
        ("9.10", "teeth_upper", -1),
        ("9.11", "teeth_lower", 1),
    ):
        if part in places.parts:
            row = places.of(part)
            score = sign * row[:, 1] - 3 * np.abs(row[:, 0]) + 0.3 * row[:, 2]
            found[fdp] = places.best(part, score)
        else:
            # No teeth: where they would be, on the mouth bag.
            lip = cage().bag[1, 5] if part == "teeth_upper" else cage().bag[1, 15]
            found[fdp] = int(lip)
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
        above = places.nearest("hair", skin[top] + [0, 30.0, 0])
    back = int(np.argmax(-skin[:, 2] - 3 * np.abs(skin[:, 1]) + midline))
    found = {"11.4": top, "11.5": above, "11.6": back}
    for fdp, column, landmark in (("11.1", 0, 10), ("11.2", AROUND - 4, 54), ("11.3", 4, 284)):
        found[fdp] = _hair_line(places, column, landmark)
    return found


def _hair_line(places: _Places, column: int, landmark: int) -> int:
    """Where hair meets the skin on the way from ``landmark`` up one column of the cage."""
    if "hair" not in places.parts:
        return landmark
    hair = places.of("hair")
    for vertex in (landmark, *cage().rings[:6, column].tolist()):
        apart = np.linalg.norm(hair - places.vertices[vertex], axis=1).min()
        if apart < 8.0:
            return int(vertex)
    return landmark
