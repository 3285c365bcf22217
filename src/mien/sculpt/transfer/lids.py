"""Lids that close as far as the source's do, on the eyeball and not through it.

Transferred gradients leave a gap: a blink is a contact, and contacts do not add up from gradients.
So the opening of each eye is measured on both faces (``opening``) and the target's lids are slid
about the middle of its eye, in elevation, until as much of it is shut as of the source's.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array, Face
from mien.sculpt.transfer.opening import (
    CELLS,
    REACH,
    STEP,
    Eye,
    Opening,
    aimed,
    azimuths,
    ball_radius,
    eye_of,
    see,
)
from mien.sculpt.transfer.skin import Skin

EYES = ("eye_left", "eye_right")
_MARGINS = {"eye_left": ("3.1", "3.3"), "eye_right": ("3.2", "3.4")}
"""Upper and lower lid."""
_LEAST = 0.05
"""Share of an opening that a shape must shut or open before its lids are looked after."""
_SHUT = 0.85
"""What shuts more than this is a blink, and shuts altogether."""
_PASS = 0.06
"""Part of the opening by which lids that are shut pass each other: their edges are polygons."""
_UPPER = (0.55, 0.95)
"""Least and greatest part of the way that the upper lid goes."""
_TALL = (0.7, 1.2)
"""Height over width of an eye's opening from which it is somewhat, and altogether, tall."""
_ROUNDS = 3
_ROOM = 2.2
"""How many times as far as its edge moves a lid must reach, that it may stretch and not fold."""
_CORNER = np.radians(14.0)
"""Beyond the corners the skin gives way over this."""
_FADE = (1.35, 2.0)
"""Distances from the eye, in those of the lids' edges, between which the skin no longer is lid."""
_CLEAR = 0.35
"""mm at which lids stay clear of the eyeball, where they were as clear at rest."""


def close_lids(
    source: Face, skin: Skin, motion: Array, target: Face, own: Skin, made: Array
) -> tuple[Array, tuple[str, ...]]:
    """``made`` (K, N, 3), motion of the target's skin ``own``, with its lids as far shut as the
    source's are by ``motion`` (K, S, 3); and what could not be done, in plain words."""
    made, notes = made.copy(), []
    for name in EYES:
        theirs = aimed(eye_of(source, name), skin.vertices, skin.triangles)
        ours = aimed(eye_of(target, name), own.vertices, own.triangles)
        before = see(theirs, skin.vertices, skin.triangles)
        rest = see(ours, own.vertices, own.triangles)
        if not before.area:
            continue
        if not rest.area:
            side = name.removeprefix("eye_")
            notes.append(f"the {side} eye is shut at rest or has no lids: it cannot blink")
            made[_blinks(theirs, skin, motion, before)] *= _elsewhere(target, own, name)
            continue
        ball = ball_radius(ours, target, name)
        for k, moved in enumerate(motion):
            after = see(theirs, skin.vertices + moved, skin.triangles)
            shut = 1.0 - after.area / before.area
            if shut < _LEAST:
                continue
            shut = 1.0 if shut > _SHUT else shut
            share = _upper_share(theirs, source, skin, moved, name)
            made[k] = _slide(ours, own, made[k], rest, shut, share, ball)
    return made, tuple(notes)


def _blinks(eye: Eye, skin: Skin, motion: Array, before: Opening) -> NDArray[np.bool_]:
    """(K,) which of the source's shapes shut its eye."""
    left = [see(eye, skin.vertices + moved, skin.triangles).area for moved in motion]
    return np.asarray(1.0 - np.array(left) / before.area > _SHUT)


def _elsewhere(face: Face, own: Skin, name: str) -> Array:
    """(N, 1) 0 on the side of the eye ``name``, 1 on the other's."""
    away = [np.linalg.norm(own.vertices - face.pivots[eye], axis=1) for eye in EYES]
    nearest = np.argmin(away, axis=0)
    return np.asarray(nearest != EYES.index(name), dtype=float)[:, None]


def _upper_share(eye: Eye, face: Face, skin: Skin, moved: Array, name: str) -> float:
    """The part of the way by which the upper lid comes down and not the lower one up."""
    low, high = _UPPER
    if not set(_MARGINS[name]) <= set(face.points.ids):
        return (low + high) / 2.0
    rows = face.points.index(_MARGINS[name])
    whole = skin.spread(moved, len(face.vertices))
    places = face.points.at(face.vertices)[rows]
    posed = places + face.points.at(whole)[rows]
    turn = eye.polar(posed)[1] - eye.polar(places)[1]
    way = -turn[0] + turn[1]
    return float(np.clip(-turn[0] / way, low, high)) if way > 1e-3 else (low + high) / 2.0


def _slide(
    eye: Eye, own: Skin, moved: Array, rest: Opening, shut: float, share: float, ball: Array
) -> Array:
    """``moved`` (N, 3) with the opening brought to 1 - ``shut`` of what it is at ``rest``."""
    gap = rest.upper - rest.lower
    share -= (share - 0.5) * _tallness(rest)
    past = _PASS * gap if shut == 1.0 else 0.0
    upper = rest.upper - share * shut * gap - past
    lower = rest.lower + (1.0 - share) * shut * gap + past
    edge = _edge_distance(eye, own, rest)
    for _ in range(_ROUNDS):
        posed = own.vertices + moved
        now = see(eye, posed, own.triangles)
        wanted = (1.0 - shut) * rest.area
        if now.area <= wanted + 0.005 * rest.area:
            break
        moved = _warp(eye, posed, now, upper, lower, edge) - own.vertices
    return _off_the_ball(eye, own, moved, ball, edge)


def _tallness(rest: Opening) -> float:
    """0 for eyes of human shape, 1 for those that are taller than wide: their lids meet half-way,
    for an upper lid that had to come all the way would drag the forehead with it."""
    height = float(np.nanmax(rest.upper - rest.lower))
    width = STEP * float(np.isfinite(rest.upper).sum())
    low, high = _TALL
    return float(np.clip((height / width - low) / (high - low), 0.0, 1.0))


def _edge_distance(eye: Eye, own: Skin, rest: Opening) -> float:
    """mm from the eye's middle to the lids' edges."""
    azimuth, elevation, distance = eye.polar(own.vertices)
    column = _column(azimuth)
    near = np.minimum(
        np.abs(elevation - rest.upper[column]), np.abs(elevation - rest.lower[column])
    )
    at = (near < np.radians(6.0)) & (np.abs(azimuth) < REACH)
    return float(np.median(distance[at])) if at.any() else float(distance.min())


def _column(azimuth: Array) -> NDArray[np.intp]:
    return np.asarray(np.clip(((azimuth + REACH) / STEP).astype(np.intp), 0, CELLS - 1))


def _warp(eye: Eye, posed: Array, now: Opening, upper: Array, lower: Array, edge: float) -> Array:
    """``posed`` (N, 3) turned about the eye so that the lids' edges as they are ``now`` come to
    elevations ``upper`` and ``lower``."""
    azimuth, elevation, distance = eye.polar(posed)
    known = np.isfinite(now.upper) & np.isfinite(upper)
    if not known.any():
        return posed
    at = azimuths()
    give = np.minimum(upper - now.upper, 0.0), np.maximum(lower - now.lower, 0.0)
    down, up, top, bottom = (
        np.interp(azimuth, at[known], values[known]) for values in (*give, now.upper, now.lower)
    )
    first, last = at[known][[0, -1]]
    beyond = np.maximum(first - azimuth, azimuth - last)
    hold = _ease(1.0 - beyond / _CORNER) * _ease(
        (_FADE[1] * edge - distance) / (edge * (_FADE[1] - _FADE[0]))
    )
    room = _ROOM * np.maximum(np.abs(down), np.abs(up)) + np.radians(4.0)
    above = (elevation - top) / room
    below = (bottom - elevation) / room
    inside = np.clip((elevation - bottom) / np.maximum(top - bottom, 1e-6), 0.0, 1.0)
    between = up + (down - up) * inside
    turn = np.where(
        above > 0, down * _ease(1 - above), np.where(below > 0, up * _ease(1 - below), between)
    )
    return eye.place(azimuth, elevation + hold * turn, distance)


def _off_the_ball(eye: Eye, own: Skin, moved: Array, ball: Array, edge: float) -> Array:
    """``moved`` with what was outside the eyeball at rest outside it still."""
    _, _, before = eye.polar(own.vertices)
    clear = before - _at(ball, eye, own.vertices)
    posed = own.vertices + moved
    azimuth, elevation, distance = eye.polar(posed)
    least = _at(ball, eye, posed) + np.minimum(clear, _CLEAR)
    low = (clear > 0.0) & (distance < least) & (before < _FADE[0] * edge)
    out = eye.place(azimuth, elevation, np.where(low, least, distance))
    return np.asarray(np.where(low[:, None], out, posed) - own.vertices)


def _at(ball: Array, eye: Eye, places: Array) -> Array:
    """(N,) mm to the eyeball's surface in the direction of each place; 0 where there is none."""
    azimuth, elevation, _ = eye.polar(places)
    seen = (np.abs(azimuth) < REACH) & (np.abs(elevation) < REACH)
    return np.asarray(np.where(seen, ball[_column(elevation), _column(azimuth)], 0.0))


def _ease(level: Array) -> Array:
    level = np.clip(level, 0.0, 1.0)
    return np.asarray(level * level * (3.0 - 2.0 * level))
