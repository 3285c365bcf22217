"""Pictures become a curve track."""

from __future__ import annotations

from collections.abc import Iterable

from mien.capture.settings import CaptureSettings, Progress
from mien.capture.snakes.stepper import SnakeCapture
from mien.capture.snakes.track import CurveTrack, Gathering
from mien.capture.snakes.watch import trace_of
from mien.errors import NoFaceError
from mien.performance.frame import Frame


def follow(
    frames: Iterable[Frame],
    stepper: SnakeCapture,
    settings: CaptureSettings,
    progress: Progress | None = None,
) -> CurveTrack:
    """Curves of every frame. Raises NoFaceError where not one shows a face."""
    gathering, size = Gathering(), (0, 0)
    for frame in frames:
        seen = stepper.step(frame.image)
        gathering.add(frame.time, seen)
        size = (frame.image.shape[1], frame.image.shape[0])
        if settings.watch is not None:
            settings.watch(trace_of(seen))
        if progress is not None:
            progress(len(gathering))
    if not gathering.faces:
        raise NoFaceError(
            f"no face was found in {len(gathering)} frames; a face must be in view, upright and lit"
        )
    return gathering.track(size)
