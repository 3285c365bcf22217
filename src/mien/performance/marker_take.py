"""A marker take: where optical markers were, frame by frame, before anything is known of a face."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class MarkerTake:
    """F frames of M markers in the axes of the room they were captured in."""

    labels: tuple[str, ...]
    """(M) as the file has them, without the subject's prefix; not always unique."""
    time: Array
    """(F,) seconds from the first frame."""
    places: Array
    """(F, M, 3) mm; NaN where a marker was not seen."""
    unit: float = 1.0
    """Millimetres in the unit of the file."""
    source: str = ""
    """Where it came from, for a person to read."""

    def __len__(self) -> int:
        return len(self.time)

    @property
    def rate(self) -> float:
        """Frames a second, on average; 1 for a single frame."""
        return (len(self) - 1) / float(self.time[-1]) if len(self) > 1 else 1.0

    @property
    def seen(self) -> NDArray[np.bool_]:
        """(F, M)"""
        return np.isfinite(self.places[..., 0])

    def cut(self, start: float, end: float) -> MarkerTake:
        """The frames from ``start`` to ``end`` seconds; time begins anew. Empty where the take
        has none."""
        kept = (self.time >= start - 1e-6) & (self.time <= end + 1e-6)
        time = self.time[kept]
        return replace(self, time=time - time[:1], places=self.places[kept])
