"""Frames or markers become a Performance. One entry in CAPTURES for each way of looking."""

from collections.abc import Iterable
from typing import Protocol

from mien.capture.detector import follow
from mien.capture.known import curve_calibration, known_or_learnt
from mien.capture.landmarks import perform
from mien.capture.neutral import ground
from mien.capture.settings import CaptureSettings, Progress
from mien.capture.snakes.capture import follow as follow_curves
from mien.capture.snakes.colour.palette import trained
from mien.capture.snakes.points import depths
from mien.capture.snakes.reading import calibrate as calibrate_curves
from mien.capture.snakes.reading import perform as perform_curves
from mien.capture.snakes.stepper import SnakeCapture
from mien.capture.tracker.capture import tracker
from mien.capture.watch import trace_of
from mien.face.library import generic_face
from mien.performance.frame import Frame
from mien.performance.performance import Performance


class Capture(Protocol):
    """Reads a whole take. ``progress`` is told how many frames are done."""

    def __call__(
        self,
        frames: Iterable[Frame],
        settings: CaptureSettings,
        source: str,
        progress: Progress | None = None,
    ) -> Performance:
        """The performance in ``frames``. Raises NoFaceError where there is none."""


def _landmarks(
    frames: Iterable[Frame],
    settings: CaptureSettings,
    source: str,
    progress: Progress | None = None,
) -> Performance:
    track = follow(frames, progress)
    base = ground(generic_face())
    known = known_or_learnt(track, base, settings)
    performance = perform(track, known, base, source)
    if settings.watch is not None:
        for frame in range(len(track)):
            settings.watch(trace_of(track, performance, known.focal, frame))
    return performance


def _snakes(
    frames: Iterable[Frame],
    settings: CaptureSettings,
    source: str,
    progress: Progress | None = None,
) -> Performance:
    if settings.performer is not None and settings.performer.curves:
        known, look, networks = curve_calibration(settings.performer.curves)
        stepper = SnakeCapture(look, trained(networks))
        return perform_curves(follow_curves(frames, stepper, settings, progress), known, source)
    track = follow_curves(frames, SnakeCapture(), settings, progress)
    learnt = calibrate_curves(
        track, depths(generic_face()), neutral=settings.neutral, focal=settings.focal
    )
    return perform_curves(track, learnt, source)


CAPTURES: dict[str, Capture] = {"landmarks": _landmarks, "snakes": _snakes, "tracker": tracker}

__all__ = ["CAPTURES", "Capture", "CaptureSettings"]
