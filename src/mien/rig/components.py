"""Connected parts of a model, and which of them are eyeballs."""

from __future__ import annotations

from dataclasses import dataclass

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
_FRONT = 0.93
"""Cosine of the angle from straight ahead within which an eyeball has vertices."""
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


def components(vertices: Array, triangles: Ints) -> NDArray[np.intp]:
    """(V,) number of the connected part of each vertex; vertices at one place are one."""
    _, welded = np.unique(vertices, axis=0, return_inverse=True)
    corners = welded.ravel()[triangles]
    edges = np.concatenate([corners[:, [0, 1]], corners[:, [1, 2]]])
    count = int(welded.max()) + 1
    graph = sparse.coo_matrix((np.ones(len(edges)), edges.T), (count, count))
    return np.asarray(connected_components(graph, directed=False)[1][welded.ravel()])


def find_ball(vertices: Array, part: NDArray[np.intp], lids: Array) -> Ball | None:
    """The eyeball behind ``lids`` (4, 3): outer and inner corner, upper and lower lid. All round
    parts about the same middle belong to it (iris, cornea). None where there is none."""
    middle, width = lids.mean(axis=0), float(np.linalg.norm(lids[0] - lids[1]))
    near = np.linalg.norm(vertices - middle, axis=1) < 2.0 * width
    found: list[tuple[int, Array, int]] = []
    for number in np.unique(part[near]):
        own = part == number
        if own.sum() < _FEWEST:
            continue
        centre, radius, off = _sphere(vertices[own])
        here = np.linalg.norm((centre - middle)[:2]) < _REACH * width
        round_ = off < _ROUND * radius and _has_front(vertices[own], centre)
        if here and round_ and _SIZES[0] < radius / width < _SIZES[1]:
            found.append((int(own.sum()), centre, int(number)))
    if not found:
        return None
    # A catch light or an iris is a part of a sphere too, but nobody models one so finely.
    centre = max(found, key=lambda ball: ball[0])[1]
    return Ball(np.isin(part, [number for _, _, number in found]), centre)


def _has_front(places: Array, centre: Array) -> bool:
    """Whether places (N, 3) on a sphere reach its front: lashes lie about a ball and do not."""
    away = places - centre
    ahead = away[:, 2] / np.maximum(np.linalg.norm(away, axis=1), 1e-12)
    return bool(ahead.max() > _FRONT)


def _sphere(places: Array) -> tuple[Array, float, float]:
    """Centre, radius and root mean square distance of the sphere through ``places`` (N, 3)."""
    origin = places.mean(axis=0)
    local = places - origin
    system = np.concatenate([2.0 * local, np.ones((len(local), 1))], axis=1)
    found = np.linalg.lstsq(system, (local**2).sum(axis=1), rcond=None)[0]
    radius = float(np.sqrt(max(found[3] + found[:3] @ found[:3], 0.0)))
    off = np.linalg.norm(local - found[:3], axis=1) - radius
    return origin + found[:3], radius, float(np.sqrt((off**2).mean()))


def round_pair(vertices: Array, part: NDArray[np.intp]) -> list[Ball]:
    """The two eyeballs of a head that is upright, by their being round and each other's mirror
    image; empty where there are none."""
    size = float(np.ptp(vertices, axis=0).max())
    found: list[tuple[int, Array, float]] = []
    for number in np.unique(part):
        own = part == number
        if own.sum() < _FEWEST:
            continue
        centre, radius, off = _sphere(vertices[own])
        round_ = off < _ROUND * radius and _has_front(vertices[own], centre)
        if round_ and radius < _LARGEST * size:
            found.append((int(number), centre, radius))
    for i, (_, centre, radius) in enumerate(found):
        for _, other, size_ in found[i + 1 :]:
            apart = np.abs(centre - other)
            level = apart[1:].max() < 0.3 * radius and abs(radius - size_) < 0.1 * radius
            if level and apart[0] > 2.0 * radius:
                return [_shells(part, found, middle, radius) for middle in (centre, other)]
    return []


def _shells(
    part: NDArray[np.intp], found: list[tuple[int, Array, float]], middle: Array, radius: float
) -> Ball:
    """All round parts about ``middle``: white, iris, cornea."""
    here = [n for n, centre, _ in found if np.linalg.norm(centre - middle) < 0.3 * radius]
    return Ball(np.isin(part, here), middle)
