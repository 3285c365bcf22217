"""What a capture saw in one picture, for people who want to look over its shoulder."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def _nothing() -> Array:
    return np.zeros((0, 2))


@dataclass(frozen=True, slots=True)
class Trace:
    """All places in pixels of the frame; the centre of the first pixel is (0.5, 0.5)."""

    curves: Mapping[str, Array] = field(default_factory=dict)
    """(N, 2) each, open polylines by name: "lip_outer_upper", "brow_left", "silhouette" ..."""
    boxes: Mapping[str, Array] = field(default_factory=dict)
    """(4, 2) each, corners of oriented rectangles by name."""
    points: Array = field(default_factory=_nothing)
    """(N, 2) features that were used."""
    wire: Array = field(default_factory=lambda: np.zeros((0, 2, 2)))
    """(E, 2, 2) ends of the edges of a fitted mesh."""
    axes: Array = field(default_factory=_nothing)
    """(4, 2) the head's origin and the tips of its x, y and z axis, or (0, 2)."""
    beside: NDArray[np.uint8] | None = None
    """(H, W, 3) a picture to show beside the frame (the transformed image), or None."""
    faces: int = 1
    """Faces in view, where the capture counts them; one is followed."""
    lost: bool = False
    """No face was found."""
    notes: tuple[str, ...] = ()
    """Short words for the reader: "brow_left lost", "recovered"."""
