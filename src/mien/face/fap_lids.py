"""Lids: how each FAP of an eye moves them, and how they slide on the eyeball meanwhile.

A whole lid opening (a value of 1024) brings every point of a margin to the other lid's, so that
lids shut along their whole length; skin follows the less, the farther it lies from the margin. The
motion of a FAP is linear, as a morph target must be, and its chord would cut through the eyeball:
half-way the lid is carried forward by a second field, the slide, whose weight is 4 t (1 - t) at
the part t of a whole opening.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mien.face.face import Array, Face, Part
from mien.face.influence import LIDS, Index, Mask, opening, rows

_SHARE_ENDS = 2.2
"""Heights of the fold above the margin at which skin no longer follows a lid."""
_DEEPEST = 0.5
"""mm nearer to the eyeball's middle than the margin's points lies what is behind the lid."""
_BAND = 1.1
"""Distances from the eyeball's middle, in those of the margin, within which skin is lid."""
_PAST = 0.35
"""mm by which margins pass each other between the middle and the corners: they are polygons."""


@dataclass(frozen=True, slots=True)
class Lid:
    """One lid of one eye."""

    motion: Array
    """(V, 3) mm at a whole opening."""
    slide: Array
    """(V, 3) mm to add half-way."""


@dataclass(frozen=True, slots=True)
class Lids:
    """Both lids of one eye."""

    upper: Lid
    lower: Lid
    area: Mask
    """(V,) skin from fold to fold: lid, which rides on the eyeball and not on brow or cheek."""


def lids(face: Face, skin: Part, side: int) -> Lids | None:
    """The lids of the left (0) or right eye, on ``skin``; None where points are missing."""
    _, top, inner, bottom = LIDS[side]
    if any(fdp not in face.points.ids for fdp in LIDS[side]):
        return None
    ball = face.pivots["eye_right" if side else "eye_left"]
    depth = min(float(np.linalg.norm(face.point(fdp) - ball)) for fdp in LIDS[side]) - _DEEPEST
    hole = opening(face, skin, LIDS[side], ball, depth)
    turn = int(np.argmin(np.linalg.norm(face.vertices[hole.rim] - face.point(inner), axis=1)))
    above = _line(face, hole.rim[: turn + 1])
    below = _line(face, np.append(hole.rim[turn:], hole.rim[0]))
    across = face.vertices[:, 0]
    upper, lower = np.interp(across, *above), np.interp(across, *below)
    between = (across > above[0][0]) & (across < above[0][-1])
    gap = np.where(between, np.maximum(upper - lower, 0.0), 0.0)
    middle = float(face.point(top)[1] - face.point(bottom)[1])
    full = np.clip(gap / middle, 0.0, 1.0)
    reach = gap + 4.0 * _PAST * full * (1.0 - full)
    on_skin = rows(face, skin) & (face.vertices[:, 2] > ball[2])
    height = face.vertices[:, 1]
    high = on_skin & (height > (upper + lower) / 2.0)
    low = on_skin & ~high
    fold_above = _fold(face, ("3.13", "3.14")[side], top, middle)
    fold_below = _fold(face, ("3.9", "3.10")[side], bottom, middle)
    near = on_skin & between & (height < upper + fold_above) & (height > lower - fold_below)
    return Lids(
        _lid(face, ball, top, -reach * high * _share(height - upper, fold_above, hole.inside)),
        _lid(face, ball, bottom, reach * low * _share(lower - height, fold_below, hole.inside)),
        near & (np.linalg.norm(face.vertices - ball, axis=1) < _BAND * depth),
    )


def _lid(face: Face, ball: Array, point: str, rise: Array) -> Lid:
    """A lid whose vertices move up by ``rise`` (V,) and keep their distance from ``ball``, except
    that its ``point`` ends straight above or below where it began, as its FAP demands."""
    motion, slide = np.zeros((2, *face.vertices.shape))
    motion[:, 1] = rise
    motion[:, 2] = _forward(face.vertices - ball, rise)
    off = face.points.at(motion)[face.points.index([point])[0]]
    if off[1]:
        motion[:, 2] -= off[2] / off[1] * rise
    slide[:, 2] = _forward(face.vertices - ball, rise / 2.0) - motion[:, 2] / 2.0
    return Lid(motion, slide)


def _forward(ray: Array, rise: Array) -> Array:
    """(V,) how much farther forward a vertex at ``ray`` (V, 3) from the eyeball's middle lies
    after it has slid up by ``rise`` (V,)."""
    ahead = (ray[:, 1:] ** 2).sum(axis=1) - (ray[:, 1] + rise) ** 2
    return np.where(rise != 0.0, np.sqrt(np.maximum(ahead, 0.0)) - ray[:, 2], 0.0)


def _share(height: Array, fold: float, inside: Mask) -> Array:
    """(V,) part of the margin's motion at ``height`` (V,) mm from it; all of it behind the lid."""
    share = np.clip(1.0 - height / (_SHARE_ENDS * fold), 0.0, 1.0) ** 2
    return np.asarray(np.where(inside, 1.0, share))


def _fold(face: Face, fold: str, margin: str, opening_height: float) -> float:
    """mm from a lid's margin to its fold; half the opening where the face does not tell."""
    if fold not in face.points.ids:
        return opening_height / 2.0
    return float(abs(face.point(fold)[1] - face.point(margin)[1]))


def _line(face: Face, rim: Index) -> tuple[Array, Array]:
    """x, increasing, and y of a margin."""
    places = face.vertices[rim]
    order = np.argsort(places[:, 0])
    return places[order, 0], places[order, 1]
