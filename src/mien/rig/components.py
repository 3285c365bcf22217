"""Connected parts of a model, and which of them are eyeballs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import connected_components

from mien.face.face import Array, Ints

_ROUND = 0.12
"""Part of its radius by which an eyeball's vertices may lie off a sphere."""
_REACH = 0.8
"""Widths of an eye within which the middle of its ball lies from the middle of its lids."""
_SIZES = (0.3, 2.0)
"""Radius of an eyeball in widths of its eye."""
_EXTENTS = (0.8, 1.2, 0.8)
"""Width, height and depth of what is modelled of an eyeball, at least, in its radii: eyes look
ahead or aside, and half a ball is enough; lashes are not as high."""
_WITHIN = 1.1
"""Radii from its middle within which lies what belongs to an eyeball: corneas bulge."""
_FEWEST = 12
_LARGEST = 0.15
"""Radius of an eyeball, at most, in lengths of the whole."""


@dataclass(frozen=True, slots=True)
class Ball:
    """An eyeball: what turns together."""

    vertices: NDArray[np.bool_]
    """(V,)"""
    centre: Array
    """(3,)"""
    aside: float = 0.0
    """Angle to +x by which its lids open aside of straight ahead, radians."""


def components(vertices: Array, triangles: Ints) -> NDArray[np.intp]:
    """(V,) number of the connected part of each vertex; vertices at one place are one."""
    _, welded = np.unique(vertices, axis=0, return_inverse=True)
    corners = welded.ravel()[triangles]
    edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]]])
    count = int(welded.max()) + 1
    graph = sparse.coo_matrix((np.ones(len(edges)), edges.T), (count, count))
    return np.asarray(connected_components(graph, directed=False)[1][welded.ravel()])


def find_ball(vertices: Array, part: NDArray[np.intp], lids: Array) -> Ball | None:
    """The eyeball behind ``lids`` (4, 3): outer and inner corner, upper and lower lid. What lies
    within it belongs to it (iris, catch lights). None where there is none."""
    middle, width = lids.mean(axis=0), float(np.linalg.norm(lids[0] - lids[1]))
    near = np.linalg.norm(vertices - middle, axis=1) < 2.0 * width
    found = [
        ball
        for ball in _round_parts(vertices, part, np.unique(part[near]))
        if np.linalg.norm((ball[1] - middle)[:2]) < _REACH * width
        and _SIZES[0] < ball[2] / width < _SIZES[1]
    ]
    if not found:
        return None
    _, centre, radius = max(found, key=lambda ball: ball[2])
    out = middle - centre
    aside = float(np.arctan2(out[0], max(float(out[2]), 1e-9)))
    return replace(_filled(vertices, part, centre, radius), aside=aside)


def round_pair(vertices: Array, part: NDArray[np.intp]) -> list[Ball]:
    """The two eyeballs of a head that is upright, by their being round and each other's mirror
    image; empty where there are none."""
    size = float(np.ptp(vertices, axis=0).max())
    found = [
        ball for ball in _round_parts(vertices, part, np.unique(part)) if ball[2] < _LARGEST * size
    ]
    for i, (_, centre, radius) in enumerate(found):
        for _, other, same in found[i + 1 :]:
            apart = np.abs(centre - other)
            level = apart[1:].max() < 0.3 * radius and abs(radius - same) < 0.1 * radius
            if level and apart[0] > 2.0 * radius:
                return [_filled(vertices, part, c, radius) for c in (centre, other)]
    return []


def _round_parts(
    vertices: Array, part: NDArray[np.intp], numbers: NDArray[np.intp]
) -> list[tuple[int, Array, float]]:
    """Number, centre and radius of those connected parts that are a ball, or the front of one.
    Lashes lie on a sphere too, but not all over it."""
    found = []
    for number in numbers:
        own = vertices[part == number]
        if len(own) < _FEWEST:
            continue
        centre, radius, off = _sphere(own)
        if off < _ROUND * radius and (np.ptp(own, axis=0) > np.array(_EXTENTS) * radius).all():
            found.append((int(number), centre, radius))
    return found


def _filled(vertices: Array, part: NDArray[np.intp], centre: Array, radius: float) -> Ball:
    """All connected parts that lie within a ball."""
    away = np.linalg.norm(vertices - centre, axis=1)
    farthest = np.zeros(int(part.max()) + 1)
    np.maximum.at(farthest, part, away)
    return Ball((farthest < _WITHIN * radius)[part], centre)


def _sphere(places: Array) -> tuple[Array, float, float]:
    """Centre, radius and root mean square distance of the sphere through ``places`` (N, 3)."""
    origin = places.mean(axis=0)
    local = places - origin
    system = np.concatenate([2.0 * local, np.ones((len(local), 1))], axis=1)
    found = np.linalg.lstsq(system, (local**2).sum(axis=1), rcond=None)[0]
    radius = float(np.sqrt(max(found[3] + found[:3] @ found[:3], 0.0)))
    off = np.linalg.norm(local - found[:3], axis=1) - radius
    return origin + found[:3], radius, float(np.sqrt((off**2).mean()))
