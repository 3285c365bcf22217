"""Points: corners of the skin's look, tracked from picture to picture and anchored to the surface
([C] section 3: low-level features).

Optical flow (Lucas and Kanade 1981, in pyramids after Bouguet 2000) finds a point again in the next
picture. It keeps the place of the skin at which it was taken up, so that what it tells of does not
drift with every frame. A point whose way back does not end where it began, or that leaves the skin
it was fixed to, is let go, and taken up anew where the skin is then.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.tracker.chart import Chart, smoothed
from mien.capture.tracker.crop import Crop
from mien.capture.tracker.reprojection import reproject
from mien.capture.tracker.state import Lens, Sites, State
from mien.numeric.gauss_newton import Linearized, tukey

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
Floats = NDArray[np.float32]
Index = NDArray[np.intp]

LOSS = tukey(4.0)
"""A point that slips to another corner tells nothing."""
_CELL = 7
"""Texels, side of the squares of skin of which each may have one point."""
_CORNER = 1.5
"""Texels over which a corner's slopes are summed."""
_WINDOW, _LEVELS = (13, 13), 2
"""Pixels and halvings of the flow."""
_BACK = 0.5
"""Pixels by which the way back may miss."""
_SLIP = 2.0
"""mm from its skin at which a point is let go."""


@dataclass(frozen=True, slots=True)
class PointTerm:
    """r = (u(Y) - seen) / sigma of points that were found again."""

    sites: Sites
    lens: Lens
    seen: Array
    """(N, 2) pixels."""
    sigma: float
    """Pixels."""
    weight: float

    def linearize(self, state: State) -> Linearized:
        """(2 N,) residuals, x and y of each point one after the other."""
        sigma = np.full(len(self.seen), self.sigma)
        both = reproject(self.sites, self.lens, self.seen, sigma, state)
        return Linearized(*both, LOSS, self.weight, group=2)


def corners(chart: Chart, look: Floats, mask: Bools) -> Index:
    """Texels at which ``look`` (M,), normalised, can be told apart in both directions: the best of
    each square of skin within ``mask`` (M,)."""
    rows = np.arange(len(chart))
    right, down = (slope * chart.inner for slope in chart.slopes(look, rows))
    a, b, c = (
        smoothed(chart.grid(product.astype(np.float32)), _CORNER).ravel()[chart.cell]
        for product in (right * right, right * down, down * down)
    )
    least = 0.5 * (a + c) - np.sqrt(0.25 * (a - c) ** 2 + b * b)
    least = np.where(mask & chart.inner, least, 0.0)
    height, width = np.divmod(chart.cell, chart.shape[1])
    square = (height // _CELL) * chart.shape[1] + width // _CELL
    order = np.lexsort((-least, square))
    _, first = np.unique(square[order], return_index=True)
    best = order[first]
    return np.asarray(best[least[best] > 0.25 * np.median(least[best])])


class PointTracks:
    """Where N points of the skin, texels ``rows``, were last seen."""

    def __init__(self, rows: Index, sites: Sites) -> None:
        self.rows, self.sites = rows, sites
        self.places = np.zeros((len(rows), 2))
        """(N, 2) pixels of the frame."""
        self.held = np.zeros(len(rows), dtype=bool)
        self._last: Crop | None = None

    def follow(self, crop: Crop) -> None:
        """Find the points that are held again in the next picture, or let them go."""
        last, held = self._last, np.flatnonzero(self.held)
        self._last = crop
        if last is None or len(held) == 0:
            return
        before = _inside(last, self.places[held])
        guess = _inside(crop, self.places[held])
        there, ok = _flow(last, crop, before, guess)
        back, ok_back = _flow(crop, last, there, before)
        near = np.linalg.norm(back - before, axis=1) < _BACK
        self.places[held] = _outside(crop, there)
        self.held[held] = ok & ok_back & near

    def term(self, lens: Lens, sigma: float, weight: float) -> PointTerm:
        """What the points that are held tell."""
        held = np.flatnonzero(self.held)
        return PointTerm(self.sites.take(held), lens, self.places[held], sigma, weight)

    def renew(self, lens: Lens, state: State, seen: Bools) -> None:
        """Let go what has left its skin in the solved ``state``, and take up what is ``seen`` (N,)
        and not held."""
        places = self.sites.seen(state)
        shown = lens.project(places)
        millimetre = lens.focal * lens.scale / float(state.translation[2])
        slipped = np.linalg.norm(shown - self.places, axis=1) > _SLIP * millimetre
        kept = self.held & seen & ~slipped
        self.places = np.where(kept[:, None], self.places, shown)
        self.held = seen.copy()

    def lose(self) -> None:
        """Let every point go."""
        self.held[:] = False


def _flow(first: Crop, second: Crop, places: Floats, guess: Floats) -> tuple[Floats, Bools]:
    size = np.maximum(first.image.shape, second.image.shape)
    there, status, _ = cv2.calcOpticalFlowPyrLK(
        _padded(first, size),
        _padded(second, size),
        places,
        guess.copy(),
        winSize=_WINDOW,
        maxLevel=_LEVELS,
        flags=cv2.OPTFLOW_USE_INITIAL_FLOW,
    )
    return np.asarray(there, dtype=np.float32), np.asarray(status.ravel() == 1)


def _padded(crop: Crop, size: NDArray[np.intp]) -> NDArray[np.uint8]:
    """Flow goes between pictures of one size."""
    down, right = (size - crop.image.shape).tolist()
    return np.asarray(
        cv2.copyMakeBorder(crop.image, 0, down, 0, right, cv2.BORDER_REPLICATE), dtype=np.uint8
    )


def _inside(crop: Crop, places: Array) -> Floats:
    """Pixels of a frame as OpenCV counts them in a crop: its first pixel's centre is (0, 0)."""
    return np.asarray(crop.scale * (places - crop.origin) - 0.5, dtype=np.float32)


def _outside(crop: Crop, places: Floats) -> Array:
    return np.asarray((places.astype(float) + 0.5) / crop.scale + crop.origin)
