"""Whom the tracker follows: a face at rest in space, its texels, its landmarks, the camera."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.capture.tracker.chart import Chart, unroll
from mien.capture.tracker.crop import Crop
from mien.capture.tracker.state import Lens, Sites
from mien.face.shape_space import ShapeSpace

Array = NDArray[np.float64]
Index = NDArray[np.intp]


@dataclass(frozen=True, slots=True)
class Person:
    """A performer as the tracker knows one."""

    space: ShapeSpace
    neutral: Array
    """(V, 3) mm at rest."""
    chart: Chart
    texels: Sites
    landmarks: Sites
    """N places the detector points at."""
    pins: tuple[NDArray[np.int32], Array]
    """(N, 3) vertices and shares of each of them."""
    rows: Index
    """(N,) their rows of a landmark track."""
    focal: float
    """Pixels."""
    centre: tuple[float, float]
    offset: Array
    """(N, 2) mm across and down, what the landmarks miss at rest: the network's constant error."""

    def lens(self, crop: Crop | None = None) -> Lens:
        """From the camera frame to pixels of the frame, or of a crop."""
        if crop is None:
            return Lens(self.focal, self.centre)
        return Lens(self.focal, self.centre, crop.scale, crop.origin)

    def attach(self, neutral: Array) -> Sites:
        """The landmarks on another face at rest (V, 3)."""
        return pinned(neutral, self.space.expression, *self.pins)

    def with_offset(self, offset: Array) -> Person:
        """The same, with the constant error of the landmarks known."""
        return replace(self, offset=offset)


def person(
    space: ShapeSpace,
    neutral: Array,
    pins: tuple[NDArray[np.int32], Array],
    rows: Index,
    focal: float,
    size: tuple[int, int],
) -> Person:
    """Somebody with ``neutral`` (V, 3) on pictures of ``size``."""
    chart = unroll(space)
    centre = (size[0] / 2.0, size[1] / 2.0)
    texels = chart.sites(neutral, space.expression)
    landmarks = pinned(neutral, space.expression, *pins)
    nothing = np.zeros((len(landmarks), 2))
    return Person(space, neutral, chart, texels, landmarks, pins, rows, focal, centre, nothing)


def pinned(neutral: Array, expression: Array, corners: NDArray[np.int32], shares: Array) -> Sites:
    """Places given by ``corners`` (N, 3) and ``shares`` (N, 3) on a face with ``neutral`` (V, 3)
    and ``expression`` (K, V, 3)."""
    place = np.einsum("ncx,nc->nx", neutral[corners], shares)
    return Sites(place, np.einsum("kncx,nc->knx", expression[:, corners], shares))
