"""What the snakes found in a take, frame by frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from mien.capture.headfit import FRONTAL
from mien.capture.snakes.curves.features import MOUTH, ROW
from mien.capture.snakes.curves.lens import lower_curve, upper_curve
from mien.capture.snakes.points import POINTS, places
from mien.capture.snakes.seen import Seen

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

_EYES = [ROW["eye_left"], ROW["eye_right"]]


@dataclass(frozen=True, slots=True)
class CurveTrack:
    """F frames of the curves; zero where lost, rotations the identity."""

    time: Array
    """(F,) seconds."""
    lenses: Array
    """(F, L + 1, 6, 2) patch units."""
    points: Array
    """(F, P, 2) feature points, pixels of the frame."""
    rotation: Array
    """(F, 3, 3) camera_from_head, as seen along the line from the camera to the head."""
    centre: Array
    """(F, 2) the middle between the eyes, pixels of the frame."""
    scale: Array
    """(F,) patch units in a pixel."""
    tongue: Array
    """(F,) 0..1"""
    irises: Array
    """(F, 2, 2) of the left and the right eye, patch units from the middle of its corners at rest,
    turned with the head."""
    plain: Array
    """(F, 2) how plainly the left and the right iris are seen, 0..1."""
    apertures: Array
    """(F, 2) how tall the left and the right eye stand open in the frame alone, patch units."""
    missed: Bools
    """(F, L) features that were not found."""
    lost: Bools
    """(F,) no face was found."""
    size: tuple[int, int]
    """Width and height of the picture."""

    def __len__(self) -> int:
        return len(self.time)

    @property
    def opening(self) -> Array:
        """(F, 2) mean height of the left and right eye, patch units: of the curves, or of what is
        eye in the frame where that is less, since a lid may fall faster than its curve."""
        eyes = self.lenses[:, _EYES]
        curves = (lower_curve(eyes) - upper_curve(eyes))[..., 1].mean(axis=-1)
        return np.asarray(np.minimum(curves, self.apertures))


class Gathering:
    """A track that grows frame by frame; it keeps numbers, not pictures."""

    def __init__(self) -> None:
        self._time: list[float] = []
        self._rows: list[_Row] = []

    def __len__(self) -> int:
        return len(self._time)

    @property
    def faces(self) -> int:
        """Frames in which a face was seen."""
        return sum(not row.lost for row in self._rows)

    def add(self, time: float, seen: Seen | None) -> None:
        """What was seen at ``time`` seconds."""
        self._time.append(time)
        self._rows.append(_NOTHING if seen is None else _row(seen))

    def track(self, size: tuple[int, int]) -> CurveTrack:
        """All of it, of pictures of ``size``."""
        columns = {
            name: np.array([getattr(row, name) for row in self._rows]) for name in _Row._fields
        }
        return CurveTrack(time=np.array(self._time), size=size, **columns)


class _Row(NamedTuple):
    """A frame of a track."""

    lenses: Array
    points: Array
    rotation: Array
    centre: Array
    scale: float
    tongue: float
    irises: Array
    plain: Array
    apertures: Array
    missed: Bools
    lost: bool


_NOTHING = _Row(
    np.zeros((MOUTH + 1, 6, 2)),
    np.zeros((len(POINTS), 2)),
    np.eye(3),
    np.zeros(2),
    1.0,
    0.0,
    np.zeros((2, 2)),
    np.zeros(2),
    np.zeros(2),
    np.ones(MOUTH, dtype=bool),
    True,
)


def _row(seen: Seen) -> _Row:
    placement = seen.placement
    frame_from_patch = np.eye(3)
    frame_from_patch[:2, :2] = placement.matrix[:, :2].T / placement.scale
    return _Row(
        seen.lenses,
        placement.to_frame(places(seen.lenses, seen.pose.rotation)),
        frame_from_patch @ seen.pose.rotation @ FRONTAL,
        placement.to_frame(np.zeros(2)),
        placement.scale,
        seen.tongue.out if seen.tongue else 0.0,
        seen.irises.aside[::-1],
        seen.irises.plain[::-1],
        seen.apertures[::-1],
        seen.lost,
        False,
    )
