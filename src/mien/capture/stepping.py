"""Captures that look at one frame at a time, for those who cannot wait for the end of the take.

Given the same calibration they see what the capture of a whole take sees; without one they learn
it from the first second in which they see a face, which should be at rest.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Protocol

import numpy as np

from mien.capture.detector import Detector
from mien.capture.landmarks import Calibration, calibrate, perform
from mien.capture.neutral import ground
from mien.capture.snakes.points import depths
from mien.capture.snakes.reading import Calibration as CurveCalibration
from mien.capture.snakes.reading import calibrate as calibrate_curves
from mien.capture.snakes.reading import perform as perform_curves
from mien.capture.snakes.stepper import SnakeCapture
from mien.capture.snakes.track import Gathering
from mien.capture.snakes.watch import trace_of
from mien.capture.track import KEPT, LandmarkTrack
from mien.face.library import generic_face
from mien.performance.frame import Frame
from mien.performance.performance import Performance
from mien.performance.trace import Trace

LEARNING = 1.0
"""Seconds of a face from which its performer is learned."""
_LEAST_FRAMES = 8


class Stepper(Protocol):
    """Follows one performer."""

    trace: Trace
    """What was seen in the last picture."""

    def step(self, frame: Frame) -> Performance | None:
        """What the performer does in ``frame``, as a performance of one frame; None until enough
        is known of them. A face that is lost keeps its last look, marked as lost."""

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
        self._seen: list[LandmarkTrack] = []
        self._last: Performance | None = None
        self._detector = Detector()
        self.trace = Trace()

    def step(self, frame: Frame) -> Performance | None:
        """See Stepper."""
        found = self._detector.landmarks(frame.image, KEPT)
        if found is None:
            self.trace = Trace(lost=True)
            return _lost(self._last, frame.time)
        self.trace = Trace(points=found[:, :2].astype(float))
        size = (frame.image.shape[1], frame.image.shape[0])
        now = LandmarkTrack(np.array([frame.time]), found[None], np.zeros(1, dtype=bool), size)
        if self._known is None:
            self._seen.append(now)
            if not self._learned():
                return None
        assert self._known is not None
        self._last = perform(now, self._known, self._ground, "live")
        return self._last

    def learn(self) -> None:
        """See Stepper."""
        self._known, self._seen, self._last = None, [], None

    def close(self) -> None:
        """See Stepper."""
        self._detector.__exit__(None, None, None)

    def _learned(self) -> bool:
        time = np.array([float(track.time[0]) for track in self._seen])
        if len(time) < _LEAST_FRAMES or time[-1] - time[0] < LEARNING:
            return False
        points = np.concatenate([track.points for track in self._seen])
        lost = np.zeros(len(time), dtype=bool)
        whole = LandmarkTrack(time, points, lost, self._seen[-1].size)
        span = (float(time[0]), float(time[-1]))
        self._known = calibrate(whole, self._ground, neutral=span, focal=self._focal)
        self._seen = []
        return True


class SnakeStepper:
    """The curves, frame by frame."""

    def __init__(self, known: CurveCalibration | None = None, focal: float | None = None) -> None:
        """``known`` from an earlier take of the same performer and camera; ``focal`` in pixels."""
        self._depth = depths(generic_face())
        self._focal = focal
        self._known = known
        self._capture = SnakeCapture()
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

    def learn(self) -> None:
        """See Stepper."""
        self._known, self._seen, self._last = None, Gathering(), None
        self._capture = SnakeCapture()

    def close(self) -> None:
        """See Stepper."""


def _lost(last: Performance | None, time: float) -> Performance | None:
    """The last look, marked as lost."""
    if last is None:
        return None
    return replace(last, time=np.array([time]), confidence=np.zeros(1), lost=np.ones(1, dtype=bool))


STEPPERS: Mapping[str, Callable[[], Stepper]] = {
    "landmarks": LandmarkStepper,
    "snakes": SnakeStepper,
}
"""Captures that can be stepped, by the name of the capture."""
