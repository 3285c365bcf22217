"""Texture: the look of the skin at rest, found again in the picture.

Both are normalised over the same visible patches (less the local mean, over the local deviation),
which takes out light and shading; the slope is that of the mean of both (Benhimane and Malis 2004,
Real-time image-based tracking of planes using efficient second-order minimization).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.capture.tracker.chart import Chart, read, smoothed
from mien.capture.tracker.state import Lens, Sites, State
from mien.numeric.gauss_newton import Linearized, cauchy

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Bools = NDArray[np.bool_]
Index = NDArray[np.intp]

_PATCH = 3.0
"""Texels, sigma of the neighbourhood over which looks are normalised."""
_FLOOR = 5.0
"""Grey levels below which differences are noise."""
_FEWEST = 100
"""Texels without which looks are not compared."""
_KNEE = 2.1
"""In median deviations."""


class Normaliser:
    """Local normalisation under one mask, for all looks that are to be compared under it."""

    def __init__(self, chart: Chart, mask: Bools) -> None:
        """``mask`` (M,) texels that are seen in both looks."""
        self.chart, self.mask = chart, mask.astype(np.float32)
        self.inner = mask & mask[chart.near].all(axis=1) & chart.inner
        """(M,) texels with a slope that the rim of the mask does not make."""
        share = smoothed(chart.grid(self.mask), _PATCH).ravel()[chart.cell]
        self._over = 1.0 / np.maximum(share, 1e-3)

    def __call__(self, look: Floats) -> Floats:
        """(M,) of ``look`` (M,) grey levels; 0 outside the mask."""
        chart = self.chart
        level = look * self.mask
        mean = smoothed(chart.grid(level), _PATCH).ravel()[chart.cell] * self._over
        square = smoothed(chart.grid(level * look), _PATCH).ravel()[chart.cell] * self._over
        spread = np.sqrt(np.maximum(square - mean * mean, 0.0) + _FLOOR**2)
        return np.asarray(self.mask * (look - mean) / spread, dtype=np.float32)


@dataclass(frozen=True, slots=True)
class TextureTerm:
    """r = F(u(Y)) - T at S of the texels, F and T normalised looks."""

    chart: Chart
    sites: Sites
    """Of all texels."""
    sampled: Sites
    """Of the texels ``rows``."""
    rows: Index
    """(S,)"""
    picture: Floats
    """(h, w) grey levels of the crop."""
    lens: Lens
    normalise: Normaliser
    wanted: Floats
    """(M,) the normalised look at rest."""
    weight: float

    def look(self, state: State) -> Floats:
        """(M,) grey levels where the posed face shows its texels."""
        return read(self.picture, self.lens.project(self.sites.seen(state)))

    def cost(self, state: State) -> float:
        """How badly the looks agree: mean difference in local deviations, large ones cut off."""
        counted = self.rows[self.normalise.inner[self.rows]]
        if len(counted) < _FEWEST:
            return 1.0
        off = np.abs(self.normalise(self.look(state))[counted] - self.wanted[counted])
        return float(np.minimum(off, 1.0).mean())

    def linearize(self, state: State) -> Linearized:
        """(S,) residuals."""
        places = self.sites.seen(state)
        pixels = self.lens.project(places)
        look = self.normalise(read(self.picture, pixels))
        rows = self.rows
        counted = self.normalise.inner[rows]
        residual = np.where(counted, look[rows] - self.wanted[rows], 0.0)
        look_right, look_down = self.chart.slopes((look + self.wanted) / np.float32(2.0), rows)
        right, down = self.chart.slopes(pixels, rows)
        area = right[:, 0] * down[:, 1] - right[:, 1] * down[:, 0]
        area = np.where(counted & (np.abs(area) > 1e-2), area, np.inf)
        gradient = np.stack(
            [
                (look_right * down[:, 1] - look_down * right[:, 1]) / area,
                (look_down * right[:, 0] - look_right * down[:, 0]) / area,
            ],
            axis=1,
        )
        seen = places[rows]
        jacobian = self.sampled.chain(self.lens.pull_back(gradient, seen), seen, state)
        deviation = float(np.median(np.abs(residual[counted]))) if counted.any() else 1.0
        deviation = max(deviation, 1e-3)
        return Linearized(residual / deviation, jacobian / deviation, cauchy(_KNEE), self.weight)
