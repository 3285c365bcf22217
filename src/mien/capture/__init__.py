"""Frames or markers become a Performance. One entry in CAPTURES for each way of looking."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Protocol

from mien.capture.detector import follow
from mien.capture.landmarks import calibrate, perform
from mien.capture.neutral import ground
from mien.capture.snakes.capture import snakes
from mien.face.library import generic_face
from mien.performance.frame import Frame
from mien.performance.performance import Performance
from mien.performance.trace import Trace

Progress = Callable[[int], None]


@dataclass(frozen=True, slots=True)
class CaptureSettings:
    """What a user may say about a take."""

    neutral: tuple[float, float] | None = None
    """Seconds (first, last) in which the face rests; None: found."""
    focal: float | None = None
    """Focal length of the camera in pixels; None: a usual one."""
    watch: Callable[[Trace], None] | None = None
    """Told what was seen in every frame, once each and in their order."""


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


CAPTURES: dict[str, Capture] = {"landmarks": _landmarks, "snakes": snakes}

__all__ = ["CAPTURES", "Capture", "CaptureSettings"]
