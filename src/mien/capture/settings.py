"""What a user may say about a take."""

from collections.abc import Callable
from dataclasses import dataclass

from mien.face.shape_space import ShapeSpace
from mien.performance.performer import Performer
from mien.performance.trace import Trace

Progress = Callable[[int], None]
"""Told how many frames are done."""


@dataclass(frozen=True, slots=True)
class CaptureSettings:
    """What a user may say about a take."""

    neutral: tuple[float, float] | None = None
    """Seconds (first, last) in which the face rests; None: found."""
    focal: float | None = None
    """Focal length of the camera in pixels; None: a usual one."""
    performer: Performer | None = None
    """What is known of the performer from earlier takes; None: learnt from this one."""
    faces: ShapeSpace | None = None
    """What the tracker knows of faces; None: the generic face's space."""
    watch: Callable[[Trace], None] | None = None
    """Told what was seen in every frame, once each and in their order."""
    notice: Callable[[str], None] | None = None
    """Told in a line what a person should know of how the take was captured."""
