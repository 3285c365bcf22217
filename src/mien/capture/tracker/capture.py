"""A whole take: met, then followed from its rest to both ends."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from mien.capture import landmarks
from mien.capture.detector import follow
from mien.capture.neutral import ground
from mien.capture.settings import CaptureSettings, Progress
from mien.capture.tracker.crop import Crop, Kept, cut, pack, unpack
from mien.capture.tracker.look import take
from mien.capture.tracker.meet import ROWS, Crops, Meeting, generic_person, meet
from mien.capture.tracker.perform import perform
from mien.capture.tracker.track import Found, Tracker
from mien.face.library import generic_face
from mien.performance.frame import Frame
from mien.performance.performance import Performance

Array = NDArray[np.float64]


class _Crops:
    """The faces of a take, packed: ten minutes must not fill the memory."""

    def __init__(self) -> None:
        self._kept: list[Kept] = []

    def look(self, frame: Frame, points: NDArray[np.float32] | None) -> None:
        """Keep the face of a frame, where one is seen."""
        if points is not None:
            self._kept.append(pack(cut(frame.image, points)))

    def __len__(self) -> int:
        return len(self._kept)

    def __getitem__(self, index: int) -> Crop:
        return unpack(self._kept[index])


def tracker(
    frames: Iterable[Frame],
    settings: CaptureSettings,
    source: str,
    progress: Progress | None = None,
) -> Performance:
    """The performance in ``frames``. Raises NoFaceError where there is none, InputError where the
    face is not seen in the seconds named neutral."""
    crops = _Crops()
    track = follow(frames, progress, crops.look)
    base = ground(generic_face())
    rest = landmarks.rest_of(track, base, neutral=settings.neutral, focal=settings.focal)
    known = landmarks.calibrate(track, base, neutral=settings.neutral, focal=settings.focal)
    points = track.points[~track.lost][:, ROWS, :2].astype(float)
    met = meet(generic_person(known, track.size), points, rest, crops)
    return perform(track, follow_both_ways(met, points, crops, rest), met, known, source)


def follow_both_ways(met: Meeting, points: Array, crops: Crops, rest: slice) -> list[Found]:
    """Every frame, followed from the resting one to the end and to the beginning."""
    middle = (rest.start + rest.stop) // 2
    found: dict[int, Found] = {}
    look = take(met.person, met.crop, met.rest)
    for way in (range(middle, len(points)), range(middle - 1, -1, -1)):
        tracker = Tracker(met.person, [look], met.rest)
        for frame in way:
            found[frame] = tracker.step(crops[frame], points[frame])
    return [found[frame] for frame in range(len(points))]
