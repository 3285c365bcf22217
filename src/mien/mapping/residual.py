"""The rest of the motion: what a blend left over at the markers, carried into the skin.

Markers are met by radial basis functions, as far as they can be believed: the residual is taken
for a random field whose covariance falls with distance (Wendland's function, of compact support,
so that what is far from all markers rests) and whose variance is what the blend leaves over at
each marker beyond its noise. Its likeliest course (Gaussian process regression, or kriging) meets
exact markers exactly, noisy ones in part, and does nothing where only noise is left:
meeting noisy markers in full makes a good blend worse.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.distance import cdist

from mien.mapping.blend import LEAST

Array = NDArray[np.float64]

REACH = 60.0
"""mm to which a marker's residual is felt."""


def spread(vertices: Array, markers: Array) -> NDArray[np.float32]:
    """(V, P) covariance of the skin at ``vertices`` (V, 3) with each of ``markers`` (P, 3), both
    at neutral; 1 at a marker."""
    return _wendland(cdist(vertices, markers)).astype(np.float32)


def believe(residual: Array, markers: Array, noise: Array) -> Array:
    """(F, P, 3) coefficients of ``spread`` from the ``residual`` (F, P, 3) left at ``markers``
    (P, 3), whose standard error is ``noise`` (P,), mm."""
    variance = np.maximum((residual**2).mean(axis=(0, 2)) - noise**2, LEAST**2)
    system = _wendland(cdist(markers, markers)) + np.diag(noise**2 / variance)
    # Two markers in one place make it singular; any sharing between them will do.
    return np.asarray(np.linalg.pinv(system, rcond=1e-9, hermitian=True) @ residual)


def _wendland(distance: Array) -> Array:
    near = np.clip(1.0 - distance / REACH, 0.0, None)
    return np.asarray(near**4 * (4.0 * distance / REACH + 1.0))
