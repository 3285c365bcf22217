"""One moment of a face in ARKit's words: what phones stream and virtual-character tools expect."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from mien.performance.performance import Performance

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ArkitFrame:
    """Axes and signs are those of Performance."""

    time: float
    """Seconds."""
    shapes: Array
    """(52,) weights in arkit52 order."""
    rotation: Array = field(default_factory=lambda: np.eye(3))
    """(3, 3) of the head from its straight look."""
    translation: Array = field(default_factory=lambda: np.zeros(3))
    """(3,) mm, of the head's origin."""
    gaze: Array = field(default_factory=lambda: np.zeros((2, 2)))
    """(2, 2) left, right eye; yaw (+ to the subject's left) and pitch (+ up), radians."""
    seen: bool = True
    """False: the sender lost the face; the other fields repeat its last look."""


def performance_of(frames: Sequence[ArkitFrame], source: str) -> Performance:
    """Frames in their order, one or more, as a performance of the vocabulary "arkit", without
    points. Time starts at the first, and so does the head's place."""
    count = len(frames)
    translation = np.array([frame.translation for frame in frames])
    seen = np.array([frame.seen for frame in frames])
    return Performance(
        points=(),
        neutral=np.zeros((0, 3)),
        time=np.array([frame.time - frames[0].time for frame in frames]),
        motion=np.zeros((count, 0, 3)),
        sigma=np.zeros((0, 3)),
        rotation=np.array([frame.rotation for frame in frames]),
        translation=translation,
        gaze=np.array([frame.gaze for frame in frames]),
        confidence=seen.astype(float),
        lost=~seen,
        unseen=np.zeros((count, 3)),
        rest_translation=translation[0],
        vocabulary="arkit",
        shapes=np.array([frame.shapes for frame in frames]),
        source=source,
    )
