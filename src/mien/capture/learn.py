"""Learning a performer from takes in which nothing else is wanted: the face at rest, lids open and
shut, the colours of the features, and key poses that are held."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from mien.capture import landmarks, lids
from mien.capture.detector import Detector
from mien.capture.detector import follow as follow_landmarks
from mien.capture.known import curve_section, landmark_section
from mien.capture.neutral import ground
from mien.capture.settings import CaptureSettings
from mien.capture.snakes import reading
from mien.capture.snakes.capture import follow as follow_curves
from mien.capture.snakes.colour.network import Network
from mien.capture.snakes.colour.palette import trained
from mien.capture.snakes.colour.training import teach
from mien.capture.snakes.curves.features import MOUTH, NAMES
from mien.capture.snakes.curves.lens import boxed, fit_lens
from mien.capture.snakes.head.flow import choose
from mien.capture.snakes.head.patch import Picture, Placement
from mien.capture.snakes.points import depths
from mien.capture.snakes.stepper import Appearance, SnakeCapture
from mien.capture.snakes.track import CurveTrack
from mien.capture.track import LandmarkTrack
from mien.errors import InputError, MissingExtraError
from mien.face.library import generic_face
from mien.performance.frame import Frame
from mien.performance.performance import Performance
from mien.performance.performer import Performer
from mien.vocabulary.topology import BROW_LOWER, BROW_UPPER, LID_LOOPS, LIP_LOOPS, mirrored

Array = NDArray[np.float64]
Play = Callable[[], Iterable[Frame]]
"""Gives the same frames again, as often as it is called."""
Rectangles = Mapping[float, Mapping[str, Array]]
"""By seconds and feature: (4,) left, top, right, bottom in pixels of the frame."""

_SHOWN = 5
"""Frames from which colours are learnt."""


@dataclass(frozen=True, slots=True)
class Lessons:
    """What the user says of the takes."""

    neutral: tuple[float, float] | None = None
    """Seconds (first, last) in which the face rests; None: found."""
    shut: tuple[float, float] | None = None
    """Seconds in which both eyes are shut; None: they are when they are narrowest."""
    focal: float | None = None
    """Pixels; None: a usual one."""
    poses: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Seconds in which a key pose is held, by its name."""
    rectangles: Rectangles = field(default_factory=dict)
    """Where features are, drawn by hand; empty: as the landmark networks see them."""


def learn(play: Play, lessons: Lessons, source: str) -> Performer:
    """What the frames of ``play`` tell of their performer.

    Raises NoFaceError where there is none, InputError for seconds without a face.
    """
    poses: dict[str, Array] = {}
    curves, performance = _learn_curves(play, lessons, source)
    poses |= _held("snakes", performance, lessons.poses)
    try:
        seen = follow_landmarks(play())
    except MissingExtraError:
        return Performer({}, curves, poses, source)
    base = ground(generic_face())
    known = landmarks.calibrate(seen, base, neutral=lessons.neutral, focal=lessons.focal)
    if lessons.shut is not None:
        shut = _named(seen, "--shut", lessons.shut)
        held = replace(seen, time=seen.time[shut], points=seen.points[shut], lost=seen.lost[shut])
        with _told_by("--shut"):
            known = landmarks.with_shut(known, held, base)
    performance = landmarks.perform(seen, known, base, source)
    poses |= _held("landmarks", performance, lessons.poses)
    return Performer(landmark_section(known), curves, poses, source)


def _learn_curves(
    play: Play, lessons: Lessons, source: str
) -> tuple[Mapping[str, Array], Performance]:
    """Once to find the rest, once to look at it, once more with what was learnt."""
    settings = CaptureSettings(lessons.neutral, lessons.focal)
    track = follow_curves(play(), SnakeCapture(), settings)
    _check(lessons, track)
    look, networks = _look_again(play(), track, lessons)
    track = follow_curves(play(), SnakeCapture(look, trained(networks)), settings)
    depth = depths(generic_face())
    known = reading.calibrate(track, depth, neutral=lessons.neutral, focal=lessons.focal)
    if lessons.shut is not None:
        shut = track.opening[_named(track, "--shut", lessons.shut)]
        with _told_by("--shut"):
            known = replace(known, lids=lids.with_shut(known.lids, shut))
    return curve_section(known, look, networks), reading.perform(track, known, source)


def _check(lessons: Lessons, track: CurveTrack) -> None:
    """Raises InputError where the user names what the takes do not show."""
    for name, seconds in lessons.poses.items():
        _named(track, f"--pose {name}", seconds)
    if lessons.shut is not None:
        _named(track, "--shut", lessons.shut)
    width, height = track.size
    for time, drawn in lessons.rectangles.items():
        if not 0.0 <= time <= track.time[-1] + 1.0:
            raise InputError(f"--features: the takes end at {track.time[-1]:g} s, before {time:g}")
        for name, (left, top, right, bottom) in drawn.items():
            if right <= 0.0 or bottom <= 0.0 or left >= width or top >= height:
                raise InputError(
                    f"--features: {name} at {time:g} s lies outside the picture, {width}x{height}"
                )


def _look_again(
    frames: Iterable[Frame], track: CurveTrack, lessons: Lessons
) -> tuple[Appearance, dict[str, Network]]:
    """The face at rest, and networks taught on a few frames whose features are known."""
    rest = reading.resting(track, lessons.neutral)
    lenses = np.median(track.lenses[rest], axis=0)
    middle = int(rest[len(rest) // 2])
    wanted = _shown(track, lessons.rectangles)
    anchor: Picture | None = None
    shown: list[tuple[Picture, Array]] = []
    stepper = SnakeCapture()
    with _Eyes(lessons.rectangles) as eyes:
        for number, frame in enumerate(frames):
            seen = stepper.step(frame.image)
            if seen is None:
                continue
            if number == middle:
                anchor = seen.grey
                known = eyes.lenses(frame, seen.placement, lenses)
                lenses = lenses if known is None else known
            if number in wanted:
                found = eyes.lenses(frame, seen.placement, seen.lenses)
                if found is not None:
                    shown.append((seen.look.patch, found))
    if anchor is None:
        raise InputError("the face was lost where it rests; name other seconds with --neutral")
    return Appearance(lenses[:MOUTH], anchor, choose(anchor)), teach(shown) if shown else {}


def _shown(track: CurveTrack, rectangles: Rectangles) -> set[int]:
    """Numbers of the frames from which colours are learnt."""
    seen = np.flatnonzero(~track.lost)
    if rectangles:
        return {int(seen[np.abs(track.time[seen] - time).argmin()]) for time in rectangles}
    chosen = np.linspace(0, len(seen) - 1, min(_SHOWN, len(seen)))
    return {int(seen[int(i)]) for i in chosen}


class _Eyes:
    """Whoever knows where the features are: the user's rectangles, or the landmark networks."""

    def __init__(self, rectangles: Rectangles) -> None:
        self._rectangles = rectangles
        self._detector: Detector | None = None

    def __enter__(self) -> _Eyes:
        if not self._rectangles:
            try:
                self._detector = Detector()
            except MissingExtraError:
                self._detector = None
        return self

    def __exit__(self, *error: object) -> None:
        if self._detector is not None:
            self._detector.__exit__(None, None, None)

    def lenses(self, frame: Frame, placement: Placement, curves: Array) -> Array | None:
        """(L + 1, 6, 2) patch units; None where nobody knows. ``curves`` are what the snakes saw,
        and stand where a rectangle is missing."""
        if self._rectangles:
            nearest = min(self._rectangles, key=lambda time: abs(time - frame.time))
            return drawn_lenses(self._rectangles[nearest], placement, curves)
        points = None if self._detector is None else self._detector.landmarks(frame.image)
        if points is None:
            return None
        return mesh_lenses(placement.to_patch(points[:, :2].astype(float)), curves)


def drawn_lenses(rectangles: Mapping[str, Array], placement: Placement, curves: Array) -> Array:
    """Lenses that fill rectangles drawn in the frame."""
    result = curves.copy()
    for row, name in enumerate((*NAMES, "mouth")):
        if name in rectangles:
            left, top, right, bottom = rectangles[name]
            half = (bottom - top) / 2.0
            middle = (top + bottom) / 2.0
            lens = boxed(np.array([left, middle]), np.array([right, middle]), half, half)
            result[row] = placement.to_patch(lens)
    return result


def mesh_lenses(points: Array, curves: Array) -> Array:
    """(L + 1, 6, 2) lenses on the landmarks (478, 2) of one frame; ``curves`` stand for nostrils,
    of which landmarks only mark the floor. Landmarks place brows too high, and curves take the
    shadow below for brow: between the two lies the truth."""
    lid, lip, inner = LID_LOOPS[0], LIP_LOOPS[3], LIP_LOOPS[0]
    edges: dict[str, Sequence[NDArray[np.intp]]] = {
        "brow_left": (BROW_UPPER, BROW_LOWER),
        "eye_left": (lid[:9][::-1], np.r_[lid[8:], lid[:1]]),
        "lips": (lip[:11], np.r_[lip[10:], lip[:1]][::-1]),
        "mouth": (inner[:11], np.r_[inner[10:], inner[:1]][::-1]),
    }
    for part in ("brow", "eye"):
        edges[f"{part}_right"] = [mirrored(edge)[::-1] for edge in edges[f"{part}_left"]]
    result = curves.copy()
    for row, name in enumerate((*NAMES, "mouth")):
        if name in edges:
            lens = fit_lens(points[edges[name][0]], points[edges[name][1]])
            result[row] = 0.5 * (lens + result[row]) if name.startswith("brow") else lens
    return result


def _held(
    capture: str, performance: Performance, poses: Mapping[str, tuple[float, float]]
) -> dict[str, Array]:
    """(P, 3) mean motion of each pose. Raises InputError where no face is seen in its seconds."""
    found = {}
    for name, seconds in poses.items():
        frames = _named(performance, f"--pose {name}", seconds)
        found[f"{capture}/{name}"] = performance.motion[frames].mean(axis=0)
    return found


@contextmanager
def _told_by(option: str) -> Iterator[None]:
    """Errors name the ``option`` that is to blame."""
    try:
        yield
    except InputError as error:
        raise InputError(f"{option}: {error}") from error


def _named(
    seen: CurveTrack | LandmarkTrack | Performance, option: str, seconds: tuple[float, float]
) -> NDArray[np.intp]:
    """Frames in the seconds that ``option`` names. Raises InputError where none shows a face."""
    first, last = seconds
    there = np.flatnonzero(~seen.lost)
    time = seen.time[there]
    found = there[(time >= first - 1e-6) & (time <= last + 1e-6)]
    if len(found) == 0:
        raise InputError(
            f"{option}: no face is seen between {first:g} and {last:g} s; "
            f"the takes show one from {time[0]:g} to {time[-1]:g} s"
        )
    return found
