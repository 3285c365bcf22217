"""Frames or markers become a Performance. One entry in CAPTURES for each way of looking."""

from collections.abc import Iterable
from typing import Protocol

from mien.capture.detector import follow
from mien.capture.landmarks import calibrate, perform
from mien.capture.neutral import ground
from mien.capture.settings import CaptureSettings, Progress
from mien.capture.snakes.capture import snakes
from mien.capture.tracker.capture import tracker
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
    known = calibrate(track, base, neutral=settings.neutral, focal=settings.focal)
    return perform(track, known, base, source)


CAPTURES: dict[str, Capture] = {"landmarks": _landmarks, "snakes": snakes, "tracker": tracker}

__all__ = ["CAPTURES", "Capture", "CaptureSettings"]
