"""How the skin follows each FAP: influence maps, and the jaw's share.

A point is in the way of another's influence only along the axes in which some FAP moves it: lips
that are pushed forward at the middle come forward as a whole, for no FAP says how far their
quarters come.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mien.face.face import Array, Face, Part
from mien.face.fap_lips import PLACES, Mouth, mouth
from mien.face.influence import Mask, Surface, part_at, rows
from mien.vocabulary.fap import simple

CHIN = "2.1"
_ON_JAW = (CHIN, "2.10", "2.11", "2.12", "2.13", "2.14")
"""Skin over the lower jaw, which goes where the bone goes."""
_STILL = (
    *("3.7", "3.8", "3.11", "3.12", "9.6", "9.7", "9.12", "9.13", "9.14", "9.15"),
    *("10.7", "10.8", "10.9", "10.10", "11.1", "11.2", "11.3"),
)
"""What no FAP moves: corners of the eyes, bone of the nose, roots of the ears, hair line."""
_ON_SKIN = {2, 3, 4, 5, 8, 9, 10}
"""Groups whose points lie on skin; but for the pupils."""
_PUPILS = {"3.5", "3.6"}
_REACH, _JAW_REACH = 0.5, 1.6
"""Of the distance of the pupils."""


@dataclass(frozen=True, slots=True)
class Skin:
    """What FAPs do to the skin, per mm of their own motion."""

    part: Mask
    """(V,) vertices that are skin."""
    maps: dict[tuple[str, int], Array]
    """(V,) influence of a point along an axis."""
    jaw: tuple[Array, ...]
    """(V,) share of the jaw's motion along each of the three axes."""
    mouth: Mouth
    lining: Mask
    """(V,) the mouth's inside, over which no influence spreads."""


def skin_of(face: Face) -> Part:
    """The part on which the chin lies. Raises KeyError where that is not known."""
    return part_at(face, int(face.points.vertices[face.points.index([CHIN])[0], 0]))


def skin(face: Face, part: Part, held: Mask) -> Skin:
    """The skin of ``face``, its ``part``; ``held`` (V,) vertices move with nothing but the lids.
    Raises KeyError for a missing point of chin or lips, InputError where the lips are in pieces."""
    lips = mouth(face, part)
    outside = part.triangles[~lips.inside[part.triangles].all(axis=1)]
    lining = lips.inside.copy()
    lining[outside] = False
    eyes = float(np.linalg.norm(face.pivots["eye_left"] - face.pivots["eye_right"]))
    plate = Surface(face.vertices, outside, face.points, _REACH * eyes, held, lips.sewn(face))
    broad = Surface(face.vertices, outside, face.points, _JAW_REACH * eyes, held)
    maps: dict[tuple[str, int], Array] = {}
    for axis in range(3):
        maps |= _maps(face, plate, axis, lips)
    jaw = tuple(_jaw(broad, axis) for axis in range(3))
    return Skin(rows(face, part), maps, jaw, lips, lining)


def _moved(surface: Surface, axis: int) -> list[str]:
    """The points of ``surface`` that FAPs move along ``axis``."""
    points = dict.fromkeys(fap.point for fap in simple() if fap.axis == axis)
    groups = {fap.point: fap.group for fap in simple()}
    return [
        fdp
        for fdp in points
        if fdp in surface.ids and groups[fdp] in _ON_SKIN and fdp not in _PUPILS
    ]


def _maps(face: Face, surface: Surface, axis: int, lips: Mouth) -> dict[tuple[str, int], Array]:
    """The maps of all points moved along ``axis``: 1 at their own, 0 at the others."""
    moved = [fdp for fdp in _moved(surface, axis) if fdp != CHIN]
    found = []
    for fdp in moved:
        one = _together(fdp)
        shared = surface.map(one, [p for p in (*moved, CHIN, *_STILL) if p not in one])
        found.append(shared if len(one) == 1 else shared * lips.share(fdp, moved))
    maps = np.array(found).reshape(len(moved), len(face.vertices))
    # Sharing out is not quite exact where a point lies inside a triangle: this makes it so.
    at = face.points.at(np.repeat(maps[..., None], 3, axis=-1))[..., 0]
    exact = np.linalg.solve(at[:, face.points.index(moved)], maps)
    return {(fdp, axis): row for fdp, row in zip(moved, exact, strict=True)}


def _jaw(surface: Surface, axis: int) -> Array:
    """(V,) the jaw's share; lips that any FAP moves along ``axis`` are left to it as a whole."""
    moved = [fdp for fdp in _moved(surface, axis) if fdp not in _ON_JAW]
    still = dict.fromkeys(p for fdp in moved for p in _together(fdp))
    return surface.map(_ON_JAW, [*still, *(fdp for fdp in _STILL if fdp not in _ON_JAW)])


def _together(fdp: str) -> tuple[str, ...]:
    """The points that share one map with ``fdp``."""
    return next((place for place in PLACES if fdp in place), (fdp,))
