"""The entry: pictures become a performance, by curves."""

from __future__ import annotations

from collections.abc import Iterable

from mien.capture.settings import CaptureSettings, Progress
from mien.capture.snakes.points import depths
from mien.capture.snakes.reading import calibrate, perform
from mien.capture.snakes.stepper import SnakeCapture
from mien.capture.snakes.track import CurveTrack, Gathering
from mien.capture.snakes.watch import trace_of
from mien.errors import NoFaceError
from mien.face.library import generic_face
from mien.performance.frame import Frame
from mien.performance.performance import Performance


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


def snakes(
    frames: Iterable[Frame],
    settings: CaptureSettings,
    source: str,
    progress: Progress | None = None,
) -> Performance:
    """The performance in ``frames``. Raises NoFaceError, InputError."""
    stepper = SnakeCapture()
    track = follow(frames, stepper, settings, progress)
    depth = depths(generic_face())
    known = calibrate(track, depth, neutral=settings.neutral, focal=settings.focal)
    return perform(track, known, source)
