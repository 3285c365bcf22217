"""How far places of a posed face are seen from where they should be."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.capture.tracker.state import Lens, Sites, State

Array = NDArray[np.float64]


def reproject(
    sites: Sites, lens: Lens, seen: Array, sigma: Array, state: State
) -> tuple[Array, Array]:
    """r = (u(Y) - seen) / sigma with ``seen`` (N, 2) and ``sigma`` (N,) in pixels: (2 N,), x and y
    of each place one after the other, and its Jacobian (2 N, 6 + K)."""
    places = sites.seen(state)
    residual = (lens.project(places) - seen) / sigma[:, None]
    jacobian = np.empty((2 * len(places), 6 + len(state.weights)))
    for axis in range(2):
        gradient = np.zeros((len(places), 2))
        gradient[:, axis] = 1.0 / sigma
        slope = lens.pull_back(gradient, places)
        jacobian[axis::2] = sites.chain(slope, places, state)
    return residual.ravel(), jacobian
