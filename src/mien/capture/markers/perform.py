"""A marker take becomes a Performance.

Roles by name, head motion undone, labels mended, gaps filled, rest found; what names left open is
told by place; and all of it turned into the head frame, which markers do not know: the generic
face is laid on the markers at rest, and its eyes give the origin and the axes.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.capture.markers.correlation import learn
from mien.capture.markers.gaps import fill, find_gaps
from mien.capture.markers.head import HeadMotion, by_nose_tip, find_head_motion
from mien.capture.markers.labels import Roles, fit_generic, name_roles, place_roles
from mien.capture.markers.mend import Event, mend
from mien.capture.markers.neutral import find_rest, named_rest
from mien.errors import FormatError, InputError
from mien.face.face import Face
from mien.formats.meshes.lengths import likely
from mien.numeric.noise import noise_of
from mien.numeric.procrustes import Similarity
from mien.performance.marker_take import MarkerTake
from mien.performance.performance import Performance

Array = NDArray[np.float64]

_FEWEST = 8
"""Feature points below which no face can be told from another."""
_SIZES = (0.6, 1.7)
"""Sizes of faces against the generic one, beyond which it is the unit that is wrong."""
_PLACED = 1.5
"""mm: a marker is glued near its feature point, not on it, and moves a little otherwise. (At 0.5 mm
characters tie themselves into knots to follow what they cannot.)"""
_LOST = 0.25
"""Share of the face's markers that must be seen in a frame."""


@dataclass(frozen=True, slots=True)
class MarkerSettings:
    """What a user may say about a marker take."""

    neutral: tuple[float, float] | None = None
    """Seconds (first, last) in which the face rests; None: found."""
    roles: Mapping[str, str] | None = None
    """Label -> FDP id, "jig" or "-"; what is not in it is told by name and place."""
    nose_tip: bool = False
    """Undo the head's motion as [Z] §3 has it, from jig and nose tip."""


@dataclass(frozen=True, slots=True)
class Mended:
    """What was found and mended in a take."""

    points: Mapping[str, str]
    """FDP id -> label."""
    events: tuple[Event, ...]
    """In the order of time."""
    noise: float
    """mm, standard error of a coordinate of a marker."""
    rest: tuple[float, float]
    """Seconds of the neutral."""


def perform(
    take: MarkerTake, face: Face, settings: MarkerSettings | None = None
) -> tuple[Performance, Mended]:
    """What the performer wearing the markers did; ``face`` is the generic face.

    Raises InputError where too few markers are known, FormatError where the take cannot be of a
    face of its size.
    """
    settings = settings or MarkerSettings()
    clean = _clean(take, settings)
    rest = _rest(take, clean.places, settings)
    neutral = clean.places[rest].mean(axis=0)
    generic = dict(zip(face.points.ids, face.points.at(face.vertices), strict=True))
    roles = place_roles(clean.roles, neutral, generic)
    onto = _lay_on(take, roles, neutral, generic)
    chosen = np.array([bool(fdp) for fdp in roles.fdp])
    told = roles.only(chosen)
    error = np.sqrt(_PLACED**2 + clean.noise**2 + (clean.error[:, chosen] ** 2).mean(axis=0))
    rotation, translation = _in_head_frame(clean.head, onto)
    middle = (rest.start + rest.stop) // 2
    performance = Performance(
        points=told.fdp,
        neutral=_turned(onto, neutral[chosen]),
        time=take.time,
        motion=(clean.places - neutral)[:, chosen] @ onto.rotation.T,
        sigma=np.repeat(error[:, None], 3, axis=1),
        rotation=rotation,
        translation=translation,
        gaze=np.zeros((len(take), 2, 2)),
        confidence=clean.seen,
        lost=clean.seen < _LOST,
        unseen=np.zeros((len(take), 3)),
        rest_rotation=rotation[middle],
        rest_translation=translation[middle],
        source=take.source,
    )
    return performance, Mended(
        points=dict(zip(told.fdp, told.labels, strict=True)),
        events=clean.events,
        noise=clean.noise,
        rest=(float(take.time[rest.start]), float(take.time[rest.stop - 1])),
    )


@dataclass(frozen=True, slots=True)
class _Clean:
    """A take whose head is still and whose M markers on the skin are where they belong."""

    head: HeadMotion
    roles: Roles
    """Of the markers on the skin."""
    places: Array
    """(F, M, 3) mm, without gaps."""
    error: Array
    """(F, M) mm, standard error of what was filled."""
    seen: Array
    """(F,) share of the markers that were."""
    noise: float
    events: tuple[Event, ...]


def _clean(take: MarkerTake, settings: MarkerSettings) -> _Clean:
    take, absent = _shown(take)
    roles = name_roles(take.labels, settings.roles)
    head = _head_motion(take, roles, settings.nose_tip)
    still, roles = head.undo(take.places)[:, ~roles.jig], roles.only(~roles.jig)
    noise = noise_of(still[:, ~roles.nameless])
    places, events = mend(still, roles.labels, roles.nameless, noise)
    roles = roles.only(~roles.nameless)
    known = np.asarray(np.isfinite(places).all(axis=-1))
    filled, error = fill(places, known, learn(places, known, noise), take.rate)
    gaps = [
        Event("gap", (roles.labels[gap.marker],), gap.first, gap.last) for gap in find_gaps(known)
    ]
    told = tuple(sorted((*absent, *events, *gaps), key=lambda event: event.first))
    return _Clean(head, roles, filled, error, known.mean(axis=1), noise, told)


def _shown(take: MarkerTake) -> tuple[MarkerTake, list[Event]]:
    """The take without markers that are never seen, and which those are."""
    shown = take.seen.any(axis=0)
    if not shown.any():
        raise InputError(f"{take.source}: no marker was seen in any frame")
    absent = [
        Event("absent", (take.labels[i],), 0, len(take) - 1)
        for i in np.flatnonzero(~shown).tolist()
        if not take.labels[i].startswith("*")
    ]
    labels = tuple(take.labels[i] for i in np.flatnonzero(shown).tolist())
    return replace(take, labels=labels, places=take.places[:, shown]), absent


def _head_motion(take: MarkerTake, roles: Roles, nose_tip: bool) -> HeadMotion:
    worn = ~roles.nameless
    if not worn.any():
        raise InputError(f"{take.source}: no column of it names a marker; label the take first")
    places, jig = take.places[:, worn], roles.jig[worn]
    if not nose_tip:
        return find_head_motion(places, jig, take.rate)[0]
    tip = [i for i, fdp in enumerate(roles.only(worn).fdp) if fdp == "9.3"]
    if jig.sum() < 3 or not tip:
        raise InputError(f"{take.source}: --nose-tip needs three jig markers and the nose tip")
    try:
        return by_nose_tip(places, jig, tip[0])
    except ValueError as error:
        raise InputError(f"{take.source}: --nose-tip: {error}") from error


def _rest(take: MarkerTake, places: Array, settings: MarkerSettings) -> slice:
    if settings.neutral is None:
        return find_rest(places, take.rate)
    return named_rest(take.time, settings.neutral)


def _lay_on(
    take: MarkerTake, roles: Roles, neutral: Array, generic: Mapping[str, Array]
) -> Similarity:
    """The similarity that lays the markers at rest on the generic face."""
    count = sum(fdp in generic for fdp in roles.fdp)
    if count < _FEWEST:
        some = ", ".join(roles.labels[:4])
        raise InputError(
            f"{take.source}: {count} of its markers ({some} ...) are known as feature points, "
            f"{_FEWEST} are needed; say which is which with --labels FILE, a line each: LABEL,8.3"
        )
    onto = fit_generic(roles.fdp, neutral, generic)
    size = 1.0 / onto.scale
    if not _SIZES[0] < size < _SIZES[1]:
        raise FormatError(
            f"{take.source}: by its unit this face is {size:.2g} times the usual size; "
            f"say --units, here likely --units {likely(neutral / take.unit)}"
        )
    return onto


def _turned(onto: Similarity, places: Array) -> Array:
    """Places in the head frame, at their own size: turned as the generic face, about its eyes."""
    return np.asarray(places @ onto.rotation.T + onto.shift / onto.scale)


def _in_head_frame(motion: HeadMotion, onto: Similarity) -> tuple[Array, Array]:
    """World-from-head rotation (F, 3, 3) and translation (F, 3); the world is the head at rest."""
    turn, shift = onto.rotation, onto.shift / onto.scale
    rotation = turn @ motion.rotation @ turn.T
    return rotation, motion.translation @ turn.T + shift - rotation @ shift
