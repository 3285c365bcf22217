"""Landmarks: where the detector says that places of the face are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.capture.tracker.reprojection import reproject
from mien.capture.tracker.state import Lens, Sites, State
from mien.numeric.gauss_newton import Linearized, Loss, cauchy

Array = NDArray[np.float64]


LOSS = cauchy(2.5)
"""Some landmarks lie where an expression that the shapes do not know has put them."""


@dataclass(frozen=True, slots=True)
class LandmarkTerm:
    """r = (u(Y) - seen) / sigma. As predictor ``seen`` has what the frame before missed taken off;
    as anchor, what the neutral frames miss."""

    sites: Sites
    lens: Lens
    seen: Array
    """(N, 2) pixels."""
    sigma: Array
    """(N,) pixels."""
    loss: Loss = LOSS
    weight: float = 1.0

    def linearize(self, state: State) -> Linearized:
        """(2 N,) residuals, x and y of each landmark one after the other."""
        both = reproject(self.sites, self.lens, self.seen, self.sigma, state)
        return Linearized(*both, self.loss, self.weight, group=2)
