"""Captures that look at one frame at a time, for those who cannot wait for the end of the take.

Given the same calibration they see what the capture of a whole take sees; without one they learn
it from the first second in which they see a face, which should be at rest.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import inf
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from mien.capture.detector import COUNTED, Detector, installed
from mien.capture.known import curve_calibration, landmark_calibration
from mien.capture.landmarks import Calibration, calibrate, perform, with_shut
from mien.capture.neutral import ground
from mien.capture.snakes.colour.palette import trained
from mien.capture.snakes.points import depths
from mien.capture.snakes.reading import Calibration as CurveCalibration
from mien.capture.snakes.reading import calibrate as calibrate_curves
from mien.capture.snakes.reading import perform as perform_curves
from mien.capture.snakes.rehearsal import rehearse
from mien.capture.snakes.stepper import SnakeCapture
from mien.capture.snakes.track import Gathering
from mien.capture.snakes.watch import trace_of
from mien.capture.track import KEPT, LandmarkTrack
from mien.capture.tracker.capture import steady
from mien.capture.tracker.crop import Crop, cut, pack, unpack
from mien.capture.tracker.meet import Meeting, generic_person
from mien.capture.tracker.meet import meet as meet_person
from mien.capture.tracker.perform import confidences
from mien.capture.tracker.perform import perform as perform_tracked
from mien.capture.tracker.person import Person
from mien.capture.tracker.trace import trace
from mien.capture.tracker.track import Found, Tracker
from mien.capture.tracker.trust import Trust
from mien.errors import InputError
from mien.face.library import generic_face
from mien.performance.frame import Frame
from mien.performance.performance import Performance
from mien.performance.performer import Performer
from mien.performance.trace import Trace

LEARNING = 1.0
"""Seconds of a face from which its performer is learned."""
_LEAST_FRAMES = 8
_RECENT = 1.0
"""Seconds of landmarks that are kept, to learn shut lids from."""
_AT_ONCE = Trust(meeting=False)
"""A second at rest shows a face from one side: a bundle of such views tells nothing of its depth
that the landmarks have not told, and would take seconds."""
_USUAL_FRAMES = 300
"""Frames that tell how well looks usually agree."""


class Stepper(Protocol):
    """Follows one performer."""

    trace: Trace
    """What was seen in the last picture."""

    def step(self, frame: Frame) -> Performance | None:
        """What the performer does in ``frame``, as a performance of one frame; None until enough
        is known of them. A face that is lost keeps its last look, marked as lost."""

    def look_around(self) -> None:
        """Once the frame has been answered: see to what could wait until then."""

    def learn(self) -> None:
        """Forget the performer's neutral, and learn it from the frames that follow."""

    def close(self) -> None:
        """Give back what is held."""


class LandmarkStepper:
    """The landmark networks, frame by frame."""

    def __init__(self, known: Calibration | None = None, focal: float | None = None) -> None:
        """``known`` from an earlier take of the same performer and camera; ``focal`` in pixels."""
        self._ground = ground(generic_face())
        self._focal = focal
        self._known = known
        self._gathered: list[LandmarkTrack] = []
        self._last: Performance | None = None
        self._recent: deque[LandmarkTrack] = deque()
        self._faces, self._counted = 1, -inf
        self._frame: Frame | None = None
        self._detector = Detector()
        self.trace = Trace()

    @property
    def seen(self) -> LandmarkTrack | None:
        """The landmarks in the last picture; None where no face was found."""
        return None if self.trace.lost or not self._recent else self._recent[-1]

    @property
    def known(self) -> Calibration | None:
        """What is known of the performer."""
        return self._known

    def step(self, frame: Frame) -> Performance | None:
        """See Stepper."""
        found = self._detector.landmarks(frame.image, KEPT)
        if found is None:
            self.trace = Trace(lost=True)
            return _lost(self._last, frame.time)
        self._frame = frame
        self.trace = Trace(points=found[:, :2].astype(float), faces=max(self._faces, 1))
        size = (frame.image.shape[1], frame.image.shape[0])
        now = LandmarkTrack(np.array([frame.time]), found[None], np.zeros(1, dtype=bool), size)
        self._recent.append(now)
        while not 0.0 <= frame.time - self._recent[0].time[0] <= _RECENT:
            self._recent.popleft()
        if self._known is None:
            self._gathered.append(now)
            if not self._learned():
                return None
        assert self._known is not None
        self._last = perform(now, self._known, self._ground, "live")
        return self._last

    def look_around(self) -> None:
        """Count the faces in view, now and then; the traces that follow tell how many."""
        frame, self._frame = self._frame, None
        if frame is not None and not 0.0 <= frame.time - self._counted < COUNTED:
            self._faces, self._counted = self._detector.faces(frame.image), frame.time

    def learn(self) -> None:
        """See Stepper."""
        self._known, self._gathered, self._last = None, [], None

    def learn_shut(self, seconds: float) -> None:
        """Both eyes were shut in the last ``seconds``, at most _RECENT. Raises InputError where
        they were not."""
        if self._known is None or not self._recent:
            raise InputError("nobody is known yet whose lids could be learnt")
        since = self._recent[-1].time[0] - seconds
        held = _joined([track for track in self._recent if track.time[0] >= since])
        self._known = with_shut(self._known, held, self._ground)

    def close(self) -> None:
        """See Stepper."""
        self._detector.__exit__(None, None, None)

    def _learned(self) -> bool:
        time = np.array([float(track.time[0]) for track in self._gathered])
        if len(time) < _LEAST_FRAMES or time[-1] - time[0] < LEARNING:
            return False
        whole = _joined(self._gathered)
        span = (float(time[0]), float(time[-1]))
        self._known = calibrate(whole, self._ground, neutral=span, focal=self._focal)
        self._gathered = []
        return True


class SnakeStepper:
    """The curves, frame by frame."""

    def __init__(
        self,
        known: CurveCalibration | None = None,
        focal: float | None = None,
        capture: SnakeCapture | None = None,
    ) -> None:
        """``known`` from an earlier take of the same performer and camera, ``capture`` that knows
        their look; ``focal`` in pixels."""
        rehearse()
        self._depth = depths(generic_face())
        self._focal = focal
        self._known = known
        self._capture = capture or SnakeCapture()
        self._seen, self._since = Gathering(), 0.0
        self._last: Performance | None = None
        self.trace = Trace()

    def step(self, frame: Frame) -> Performance | None:
        """See Stepper."""
        seen = self._capture.step(frame.image)
        self.trace = trace_of(seen)
        if seen is None:
            return _lost(self._last, frame.time)
        size = (frame.image.shape[1], frame.image.shape[0])
        if self._known is None:
            self._since = self._since if len(self._seen) else frame.time
            self._seen.add(frame.time, seen)
            if len(self._seen) < _LEAST_FRAMES or frame.time - self._since < LEARNING:
                return None
            whole, span = self._seen.track(size), (self._since, frame.time)
            self._known = calibrate_curves(whole, self._depth, neutral=span, focal=self._focal)
        now = Gathering()
        now.add(frame.time, seen)
        self._last = perform_curves(now.track(size), self._known, "live")
        return self._last

    def look_around(self) -> None:
        """See Stepper."""

    def learn(self) -> None:
        """See Stepper."""
        self._known, self._seen, self._last = None, Gathering(), None
        self._capture = SnakeCapture()

    def close(self) -> None:
        """See Stepper."""


class TrackerStepper:
    """The 3D tracker, frame by frame. Whom it follows it meets anew each time, by the look of the
    first second, even where the landmarks know the performer from an earlier take."""

    def __init__(self, known: Calibration | None = None, focal: float | None = None) -> None:
        """``known`` of the landmarks, from an earlier take of the same performer and camera;
        ``focal`` in pixels."""
        self._landmarks = LandmarkStepper(known, focal)
        self._gathered: list[tuple[LandmarkTrack, Crop]] = []
        self._met: Meeting | None = None
        self._following: Tracker | None = None
        self._costs: deque[float] = deque(maxlen=_USUAL_FRAMES)
        self._last: Performance | None = None
        self.trace = Trace()

    def step(self, frame: Frame) -> Performance | None:
        """See Stepper."""
        plain, seen = self._landmarks.step(frame), self._landmarks.seen
        self.trace = self._landmarks.trace
        if seen is None:
            if self._following is not None:
                self._following.lose()
            return _lost(self._last, frame.time)
        # Packed as the capture of a whole take keeps it: live and offline see the same greys.
        crop = unpack(pack(cut(frame.image, seen.points[0])))
        if self._following is None:
            self._gathered.append((seen, crop))
            time = [float(track.time[0]) for track, _ in self._gathered]
            if plain is None or len(time) < _LEAST_FRAMES or time[-1] - time[0] < LEARNING:
                return None
            found = self._meet()
        else:
            found = self._following.step(crop, _places(seen, self._following.person))
        assert self._met is not None
        assert self._landmarks.known is not None
        assert plain is not None
        self._costs.append(found.cost)
        self.trace = replace(trace(self._met.person, found), faces=self._landmarks.trace.faces)
        tracked = perform_tracked(seen, [found], self._met, self._landmarks.known, plain)
        trust = confidences(np.array(self._costs))[-1:]
        self._last = replace(tracked, confidence=trust)
        return self._last

    def look_around(self) -> None:
        """See Stepper."""
        self._landmarks.look_around()

    def learn(self) -> None:
        """See Stepper."""
        self._landmarks.learn()
        self._gathered, self._met, self._following, self._last = [], None, None, None
        self._costs.clear()

    def close(self) -> None:
        """See Stepper."""
        self._landmarks.close()

    def _meet(self) -> Found:
        """Meet the performer in the frames that were gathered, and follow them to the last."""
        assert self._landmarks.known is not None
        tracks, crops = zip(*self._gathered, strict=True)
        somebody = generic_person(self._landmarks.known, tracks[-1].size)
        points = np.stack([_places(track, somebody) for track in tracks])
        rest = slice(0, len(points))
        self._met = meet_person(somebody, points, rest, crops, _AT_ONCE)
        look = steady(self._met, points, crops, rest)
        self._following = Tracker(self._met.person, [look], self._met.rest)
        self._gathered = []
        for frame in range(len(points) // 2, len(points)):
            found = self._following.step(crops[frame], points[frame])
        return found


def _places(track: LandmarkTrack, person: Person) -> NDArray[np.float64]:
    """(N, 2) pixels of a person's landmarks in a track of one frame."""
    return np.asarray(track.points[0, person.rows, :2], dtype=float)


def _joined(tracks: Sequence[LandmarkTrack]) -> LandmarkTrack:
    time = np.concatenate([track.time for track in tracks])
    points = np.concatenate([track.points for track in tracks])
    return LandmarkTrack(time, points, np.zeros(len(time), dtype=bool), tracks[-1].size)


def _lost(last: Performance | None, time: float) -> Performance | None:
    """The last look, marked as lost."""
    if last is None:
        return None
    return replace(last, time=np.array([time]), confidence=np.zeros(1), lost=np.ones(1, dtype=bool))


STEPPERS: Mapping[str, Callable[[], Stepper]] = {
    "landmarks": LandmarkStepper,
    "snakes": SnakeStepper,
    "tracker": TrackerStepper,
}
"""Captures that can be stepped, by the name of the capture."""
_OWN = ("snakes",)
"""Those that need no networks."""


def available() -> tuple[str, ...]:
    """What can be stepped here, the default first: without the landmark networks the curves."""
    return tuple(STEPPERS) if installed() else _OWN


def meet(capture: str, performer: Performer | None) -> Stepper:
    """A stepper of the ``capture`` that knows what ``performer`` tells it. Raises KeyError for an
    unknown capture, FormatError where what is told is not sound."""
    if performer is not None and capture == "landmarks" and performer.landmarks:
        return LandmarkStepper(landmark_calibration(performer.landmarks))
    if performer is not None and capture == "snakes" and performer.curves:
        known, look, networks = curve_calibration(performer.curves)
        return SnakeStepper(known, capture=SnakeCapture(look, trained(networks)))
    if performer is not None and capture == "tracker" and performer.landmarks:
        return TrackerStepper(landmark_calibration(performer.landmarks))
    return STEPPERS[capture]()
