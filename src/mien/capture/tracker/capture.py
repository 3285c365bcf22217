"""A whole take: watched once, its performer met, then followed from rest to both ends."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.capture import landmarks
from mien.capture.detector import follow
from mien.capture.known import known_or_learnt
from mien.capture.neutral import ground
from mien.capture.settings import CaptureSettings, Progress
from mien.capture.track import LandmarkTrack
from mien.capture.tracker.crop import Crop, Kept, cut, pack, unpack
from mien.capture.tracker.look import Look, take
from mien.capture.tracker.meet import Crops, Meeting, generic_person, meet
from mien.capture.tracker.perform import perform
from mien.capture.tracker.person import Person
from mien.capture.tracker.trace import trace
from mien.capture.tracker.track import Found, Tracker
from mien.capture.tracker.trust import Trust
from mien.face.library import generic_face
from mien.performance.frame import Frame
from mien.performance.performance import Performance
from mien.performance.trace import Trace

Array = NDArray[np.float64]


_UNLIKE = 0.5
"""Disagreement with the look at rest beyond which a take is left to the landmarks: films of faces
stay below 0.35, and what has nothing in common comes to 0.63."""


class Faces:
    """The faces of a take, packed: ten minutes must not fill the memory."""

    def __init__(self) -> None:
        self._kept: list[Kept] = []

    def look(self, frame: Frame, points: NDArray[np.float32] | None) -> None:
        """Keep the face of a frame, where one is seen."""
        if points is not None:
            self._kept.append(pack(cut(frame.image, points)))

    def __getitem__(self, index: int) -> Crop:
        return unpack(self._kept[index])


@dataclass(frozen=True, slots=True)
class Followed:
    """The result for the frames of a take that show a face."""

    met: Meeting
    found: list[Found]


def tracker(
    frames: Iterable[Frame],
    settings: CaptureSettings,
    source: str,
    progress: Progress | None = None,
) -> Performance:
    """The performance in ``frames``. Raises NoFaceError where there is none, InputError where the
    face is not seen in the seconds named neutral."""
    faces = Faces()
    track = follow(frames, progress, faces.look)
    base = ground(generic_face())
    rest = landmarks.rest_of(track, base, neutral=settings.neutral, focal=settings.focal)
    known = known_or_learnt(track, base, settings)
    plain = landmarks.perform(track, known, base, source)
    done = follow_take(track, faces, generic_person(known, track.size, settings.faces), rest)
    if settings.watch is not None:
        _show(settings, track, done)
    if np.median([found.cost for found in done.found]) > _UNLIKE:
        if settings.notice is not None:
            settings.notice("the skin's look at rest is not found again; landmarks alone are used")
        return plain
    return perform(track, done.found, done.met, known, plain)


def follow_take(
    track: LandmarkTrack, faces: Crops, somebody: Person, rest: slice, trust: Trust | None = None
) -> Followed:
    """Meet ``somebody`` in a take and follow them. ``rest`` are the neutral ones among the frames
    that show a face, and ``faces`` those frames' crops."""
    points = track.points[~track.lost][:, somebody.rows, :2].astype(float)
    met = meet(somebody, points, rest, faces, trust)
    middle = (rest.start + rest.stop) // 2
    gap = _gaps(track)
    look = steady(met, points, faces, rest, trust)
    found: dict[int, Found] = {}
    for way in (range(middle, len(points)), range(middle - 1, -1, -1)):
        following = Tracker(met.person, [look], met.rest, trust)
        for frame in way:
            if gap[frame if way.step > 0 else frame + 1]:
                following.lose()
            found[frame] = following.step(faces[frame], points[frame])
    return Followed(met, [found[frame] for frame in range(len(points))])


def steady(
    met: Meeting, points: Array, faces: Crops, rest: slice, trust: Trust | None = None
) -> Look:
    """The mean look of the resting frames, each read where the face lies in it: noise goes."""
    first = take(met.person, met.crop, met.rest)
    following = Tracker(met.person, [first], met.rest, trust)
    looks = [first]
    for frame in range(rest.start, rest.stop):
        found = following.step(faces[frame], points[frame])
        looks.append(take(met.person, faces[frame], found.state))
    levels = (np.mean(each, axis=0) for each in zip(*(look.levels for look in looks), strict=True))
    return Look(tuple(levels), first.seen, met.rest)


def _gaps(track: LandmarkTrack) -> NDArray[np.bool_]:
    """(F,) of the frames that show a face: none was seen just before."""
    seen = np.flatnonzero(~track.lost)
    return np.diff(seen, prepend=seen[0] - 1) > 1


def _show(settings: CaptureSettings, track: LandmarkTrack, done: Followed) -> None:
    """Tell the user's ``watch`` what was seen in every frame."""
    left = iter(done.found)
    for lost in track.lost.tolist():
        if settings.watch is not None:
            shown = Trace(lost=True) if lost else trace(done.met.person, next(left))
            settings.watch(replace(shown, faces=track.faces))
