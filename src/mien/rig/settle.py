"""Feature points settled by what the shapes do: seams that a picture of the neutral hides.

Where two lips or two lids touch, a point found by looking may lie on either. The shape that parts
them tells.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array

Fields = NDArray[np.float32]

_LIDS = (("3.1", "3.3", "3.7", "3.11"), ("3.2", "3.4", "3.12", "3.8"))
"""Upper and lower margin, outer and inner corner."""
_BROWS = (
    (("4.1", "4.3", "4.5"), ("3.7", "3.11")),
    (("4.2", "4.4", "4.6"), ("3.12", "3.8")),
)
"""Points of a brow, and the corners of its eye."""
_CLOSE, _LIFTED, _BEHIND = 0.4, 0.05, 0.3
"""Widths of an eye within which a brow's peak is its point's, and which it travels at least; part
of its way that a point makes that is left behind."""
_LIPS = (
    *(("2.2", "8.1", True), ("2.3", "8.2", False)),
    *(("2.6", "8.5", True), ("2.7", "8.6", True), ("2.8", "8.7", False), ("2.9", "8.8", False)),
)
"""Inner and outer point of a lip, and whether it is the upper."""
_COLUMNS = {
    0.0: (("2.2", "8.1"), ("2.3", "8.2")),
    0.5: (("2.6", "8.5", "8.10"), ("2.8", "8.7")),
    -0.5: (("2.7", "8.6", "8.9"), ("2.9", "8.8")),
}
"""Points of the upper and the lower lip, by halves of the mouth's width to the left."""
_ASIDE, _HIGH = 0.3, 0.9
"""Widths of an eye within which its margins lie from the middle of its corners."""
_TRAVELS = 0.15
"""Widths of an eye a lid travels, to be known by it."""
_PARTED = 0.04
"""Widths of the mouth by which a shape must part the lips, to tell them from each other."""


def settle(
    places: Mapping[str, Array],
    vertices: Array,
    fields: Fields,
    *,
    lids: bool,
    sure: Collection[str] = (),
) -> dict[str, Array]:
    """``places`` (3,) by FDP id with lid margins and inner lips where ``fields`` (K, V, 3) show
    them to be; ``vertices`` (V, 3), upright; ``lids`` False leaves the margins, and points that
    are ``sure`` stay in any case."""
    found = dict(places)
    if len(fields):
        for margins in _LIDS if lids else ():
            if all(name in places for name in margins):
                _settle_lids(found, margins, vertices, fields)
        for brow, corners in _BROWS:
            if all(name in places for name in (*brow, *corners)):
                _settle_brow(found, brow, corners, vertices, fields)
        if all(name in places for name in ("8.1", "8.2", "8.3", "8.4")):
            _settle_lips(found, vertices, fields)
    return found | {name: places[name] for name in sure}


def _settle_brow(
    found: dict[str, Array],
    brow: tuple[str, ...],
    corners: tuple[str, str],
    vertices: Array,
    fields: Fields,
) -> None:
    """Brows that are not painted are where shapes lift them: a point that a shape with its peak
    close by leaves behind goes there."""
    width = float(np.linalg.norm(found[corners[0]] - found[corners[1]]))
    lift = np.abs(fields[:, :, 1])
    peak, high = lift.argmax(axis=1), lift.max(axis=1)
    sane = (high > _LIFTED * width) & (high < width)
    for name in brow:
        away = np.linalg.norm(vertices[peak] - found[name], axis=1)
        behind = lift[:, _nearest(vertices, found[name])] < _BEHIND * high
        key = int(np.where(sane & behind, away, np.inf).argmin())
        if sane[key] and behind[key] and away[key] < _CLOSE * width:
            found[name] = vertices[peak[key]]


def _settle_lids(
    found: dict[str, Array], margins: tuple[str, str, str, str], vertices: Array, fields: Fields
) -> None:
    upper, lower, outer, inner = margins
    middle = (found[outer] + found[inner]) / 2.0
    width = float(np.linalg.norm(found[outer] - found[inner]))
    away = np.abs(vertices - middle)
    near = np.flatnonzero(
        (away[:, 0] < _ASIDE * width) & (away[:, 1] < _HIGH * width) & (away[:, 2] < width)
    )
    if not len(near):
        return
    rise = fields[:, near, 1]
    # What carries a thing away hides it: no lid travels farther than its eye is wide.
    sane = np.abs(rise).max(axis=1) < 1.5 * width
    falls = np.where(sane, -rise.min(axis=1), 0.0)
    key = int(falls.argmax())
    if falls[key] < _TRAVELS * width:
        return
    found[upper] = vertices[near[rise[key].argmin()]]
    if rise[key].max() > 0.1 * falls[key]:
        found[lower] = vertices[near[rise[key].argmax()]]


def _settle_lips(found: dict[str, Array], vertices: Array, fields: Fields) -> None:
    mouth = float(np.linalg.norm(found["8.3"] - found["8.4"]))
    row = {name: _nearest(vertices, found[name]) for name in ("8.1", "8.2")}
    parted = fields[:, row["8.1"], 1] - fields[:, row["8.2"], 1]
    key = int(parted.argmax())
    if parted[key] < _PARTED * mouth:
        _settle_line(found, mouth, vertices, fields)
        return
    for inner, outer, upper in _LIPS:
        if inner not in found or outer not in found:
            continue
        near = np.flatnonzero(np.linalg.norm(vertices - found[inner], axis=1) < 0.25 * mouth)
        partner = "8.2" if upper else "8.1"
        own = fields[key, _nearest(vertices, found[outer])]
        other = fields[key, row[partner]]
        mine = near[
            np.linalg.norm(fields[key, near] - own, axis=1)
            < np.linalg.norm(fields[key, near] - other, axis=1)
        ]
        if len(mine):
            found[inner] = vertices[mine[_nearest(vertices[mine], found[inner])]]


def _settle_line(found: dict[str, Array], mouth: float, vertices: Array, fields: Fields) -> None:
    """A mouth that is a line drawn on a face: what rises of it is the upper lip, inside and out,
    and what falls the lower."""
    aside = {x: _near_line(found, mouth, vertices, x) for x in _COLUMNS}
    middle = fields[:, aside[0.0], 1]
    if not middle.size:
        return
    key = int(np.ptp(middle, axis=1).argmax())
    if np.ptp(middle[key]) < _PARTED * mouth:
        return
    for column, near in aside.items():
        if len(near):
            rise = fields[key, near, 1]
            places = vertices[near[rise.argmax()]], vertices[near[rise.argmin()]]
            for names, place in zip(_COLUMNS[column], places, strict=True):
                found |= dict.fromkeys((name for name in names if name in found), place)


def _near_line(
    found: dict[str, Array], mouth: float, vertices: Array, column: float
) -> NDArray[np.intp]:
    """Vertices near the mouth's line at ``column`` halves of its width to the left."""
    corners = found["8.3"], found["8.4"]
    centre = (corners[0] + corners[1]) / 2.0 + column * (corners[0] - corners[1]) / 2.0
    away = np.abs(vertices - centre)
    return np.flatnonzero((away[:, 0] < 0.13 * mouth) & (away < 0.5 * mouth).all(axis=1))


def _nearest(vertices: Array, place: Array) -> int:
    return int(np.linalg.norm(vertices - place, axis=1).argmin())
