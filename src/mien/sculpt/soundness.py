"""Is a sculpted face sound? What no eye sees on a contact sheet, in degrees and millimetres.

Places are a character's vertices (..., V, 3) in some pose, its skin first.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from mien.sculpt.anatomy.cage import LIDS, LIPS, cage
from mien.sculpt.anatomy.skin import labels

Array = NDArray[np.float64]
Index = NDArray[np.intp]

_UPPER_LIP, _LOWER_LIP = np.arange(11), -np.arange(11) % 20
"""Positions of a lip loop from the right corner to the left, by either lip."""
_UPPER_LID, _LOWER_LID = np.arange(9), -np.arange(9) % 16
"""Likewise of a lid loop, from the outer corner to the inner."""
_NEAR = 24
"""Triangles tried for a point: those whose middles are nearest."""
_SUNK = 8.0
"""mm: what lies farther before a skin that it is beside has not come through it."""


def turned(skin: Array, posed: Array) -> Array:
    """(..., T) degrees between the normals of each triangle on ``skin`` (V, 3) and ``posed``
    (..., V, 3)."""
    before, after = _normals(skin), _normals(posed)
    cosine = (before * after).sum(axis=-1)
    cosine /= np.linalg.norm(before, axis=-1) * np.linalg.norm(after, axis=-1) + 1e-12
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1, 1))))


def thinness(posed: Array) -> Array:
    """(..., T) mm, the least height of each skin triangle; 0 is degenerate."""
    return np.asarray(np.linalg.norm(_normals(posed), axis=-1) / (_longest(posed) + 1e-12))


def lid_gap(posed: Array, side: int) -> Array:
    """(...) the widest mm between upper and lower lid margin of the left (0) or right eye;
    negative where they overlap all along."""
    margin = LIDS[side][0]
    return _gap(posed[..., along(margin[_UPPER_LID]), :], posed[..., along(margin[_LOWER_LID]), :])


def lip_gap(posed: Array) -> Array:
    """(...) the widest mm between upper and lower lip, seen from in front."""
    edge = LIPS[0]
    return _gap(posed[..., along(edge[_UPPER_LIP]), :], posed[..., along(edge[_LOWER_LIP]), :])


def lip_overlap(posed: Array) -> float:
    """mm by which the lips of one pose (V, 3) pass through each other."""
    upper, lower = _lip_triangles(True), _lip_triangles(False)
    above, below = posed[np.unique(upper)], posed[np.unique(lower)]
    # A lip sunk into the other lies, upside down, above that one's skin seen from within.
    sunk = _beyond(above * _UPSIDE_DOWN, posed[lower[:, ::-1]] * _UPSIDE_DOWN)
    raised = _beyond(below, posed[upper[:, ::-1]])
    return max(float(sunk.max(initial=0.0)), float(raised.max(initial=0.0)))


def teeth_through(posed: Array, teeth: Array) -> float:
    """mm by which ``teeth`` (N, 3) come through the outer skin of one pose (V, 3), measured away
    from the middle of their arc."""
    middle = np.array([0.0, teeth[:, 2].min() - 5.0])
    reach = np.hypot(teeth[:, 0], teeth[:, 2] - middle[1]).max()

    def unrolled(places: Array) -> Array:
        aside, ahead = places[..., 0], places[..., 2] - middle[1]
        return np.stack(
            [reach * np.arctan2(aside, ahead), np.hypot(aside, ahead), -places[..., 1]], axis=-1
        )

    return float(_beyond(unrolled(teeth), unrolled(posed[_outer_triangles()])).max(initial=0.0))


_UPSIDE_DOWN = np.array([-1, -1, 1])


def _beyond(points: Array, corners: Array) -> Array:
    """(N,) mm by which ``points`` (N, 3) lie above those of the triangles (T, 3, 3) that face up
    (+y), square to the triangle; 0 for a point that is over none."""
    a, ab, ac = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = np.cross(ab, ac)
    length = np.linalg.norm(normal, axis=1) + 1e-12
    up = normal[:, 1] / length
    facing = up > 0.05
    if not facing.any():
        return np.zeros(len(points))
    corners, a, normal = corners[facing], a[facing], (normal / length[:, None])[facing]
    tree = cKDTree(corners.mean(axis=1)[:, [0, 2]])
    _, near = tree.query(points[:, [0, 2]], k=min(_NEAR, len(corners)))
    inside = np.ones(near.shape, dtype=bool)
    for k in range(3):
        start, end = corners[:, k][near], corners[:, (k + 1) % 3][near]
        edge, out = end - start, points[:, None] - start
        inside &= edge[..., 2] * out[..., 0] - edge[..., 0] * out[..., 2] >= 0
    height = ((points[:, None] - a[near]) * normal[near]).sum(axis=-1)
    return np.asarray(np.where(inside & (height < _SUNK), height, 0.0).max(axis=1, initial=0.0))


def _corners(posed: Array) -> tuple[Array, Array, Array]:
    a, b, c = cage().subdivision.triangles.T
    return posed[..., a, :], posed[..., b, :], posed[..., c, :]


def _normals(posed: Array) -> Array:
    a, b, c = _corners(posed)
    return np.cross(b - a, c - a)


def _longest(posed: Array) -> Array:
    a, b, c = _corners(posed)
    sides = [((p - q) ** 2).sum(axis=-1) for p, q in ((a, b), (b, c), (c, a))]
    return np.asarray(np.sqrt(np.max(sides, axis=0)))


def _gap(upper: Array, lower: Array) -> Array:
    """Of two lines (..., N, 3) across the face: how far the first runs above the second."""
    across = np.linspace(0, 1, 41)[1:-1]
    flat = zip(
        upper.reshape(-1, *upper.shape[-2:]), lower.reshape(-1, *lower.shape[-2:]), strict=True
    )
    return np.array([_widest(a, b, across) for a, b in flat]).reshape(upper.shape[:-2])


def _widest(upper: Array, lower: Array, across: Array) -> float:
    sign = np.sign(upper[-1, 0] - upper[0, 0])
    start, end = sign * upper[0, 0], sign * upper[-1, 0]
    x = start + (end - start) * across
    above = np.interp(x, sign * upper[:, 0], upper[:, 1])
    return float((above - np.interp(x, sign * lower[:, 0], lower[:, 1])).max())


def along(line: Index) -> Index:
    """The vertices of the skin along a ``line`` of the cage, those between included."""
    number = _edge_number()
    path = [int(line[0])]
    for a, b in zip(line[:-1].tolist(), line[1:].tolist(), strict=True):
        path += [number[min(a, b), max(a, b)], b]
    return np.array(path)


@cache
def _edge_number() -> dict[tuple[int, int], int]:
    mesh = cage()
    return {(a, b): mesh.count + n for n, (a, b) in enumerate(mesh.subdivision.edges.tolist())}


@cache
def _lip_triangles(upper: bool) -> Index:
    """(N, 3) triangles of one lip's skin and of the first ring of the bag behind it."""
    at = _UPPER_LIP[1:-1] if upper else _LOWER_LIP[1:-1]
    marked = cage().label(np.append(LIPS[:4, at].ravel(), cage().bag[0, at]))
    triangles = cage().subdivision.triangles
    return triangles[(marked[triangles] > 0.35).all(axis=1)]


@cache
def _outer_triangles() -> Index:
    """(N, 3) triangles of face and lips, the mouth's inside left out."""
    triangles, label = cage().subdivision.triangles, labels()
    return triangles[((label.bag[triangles] < 0.05) & (label.mask[triangles] > 0.9)).all(axis=1)]
