"""Cardinal basis functions [B] §4.1-5.3: weights that are exact at every example.

    v_i      example: motion of the source's feature points, here whitened   eq. 5
    F        feature: leading eigenvectors of the examples' covariance       eq. 6
    p_i      places: F v_i                                                   eq. 7
    a        linear: coefficients of A_l(p) = p_l                            eq. 9
    B        cubic B-spline, alpha_j the distance to the nearest neighbour   eq. 11
    r        radial: what interpolates the linear part's residuals           eq. 12

The paper's A_0 = 1 is left out and the neutral is always an example with all weights zero, so
that both parts vanish where nothing moves.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.numeric.bspline import cubic

Array = NDArray[np.float64]

_ALIKE = 1e-9
"""Examples closer than this count as this far apart, so that two that cannot be told apart share
their weight instead of making eq. 12 singular."""


@dataclass(frozen=True, slots=True)
class CardinalFunctions:
    """Weight functions w(v) of M examples and the neutral, for W weights."""

    feature: Array
    """(L, N) rows are eigenvectors."""
    places: Array
    """(M + 1, L), the neutral first."""
    dilation: Array
    """(M + 1,) alpha."""
    linear: Array
    """(L, W)"""
    radial: Array
    """(M + 1, W)"""

    def __call__(self, motion: Array) -> Array:
        """Weights (F, W) of ``motion`` (F, N), [B] eq. 8 at eq. 13."""
        place = motion @ self.feature.T
        return np.asarray(place @ self.linear + self._bells(place) @ self.radial)

    def _bells(self, place: Array) -> Array:
        return cubic(_distances(place, self.places) / self.dilation)


def fit(examples: Array, targets: Array, ridge: float, threshold: float) -> CardinalFunctions:
    """Weight functions that take value ``targets`` (M, W) at ``examples`` (M, N), and zero at
    zero.

    Examples come whitened: divided by the standard error of each coordinate, so that ``ridge`` and
    ``threshold`` are in units of the noise's variance whatever the units of the motion. ``ridge``
    is added to the normal equations of the linear part: without it directions in which the
    examples hardly differ turn noise into large weights. Eigenvectors whose eigenvalue (variance
    over the examples) is not above ``threshold`` are dropped.
    """
    motion = np.concatenate([np.zeros((1, examples.shape[1])), examples])
    wanted = np.concatenate([np.zeros((1, targets.shape[1])), targets])
    _, singular, axes = np.linalg.svd(motion - motion.mean(axis=0), full_matrices=False)
    variance = singular**2 / len(motion)
    feature = axes[variance > max(threshold, 1e-12 * variance[0])]
    places = motion @ feature.T
    linear = np.linalg.lstsq(
        np.concatenate([places, np.sqrt(ridge) * np.eye(len(feature))]),
        np.concatenate([wanted, np.zeros((len(feature), wanted.shape[1]))]),
        rcond=None,
    )[0]
    apart = np.maximum(_distances(places, places), _ALIKE)
    np.fill_diagonal(apart, np.inf)
    dilation = apart.min(axis=1)
    np.fill_diagonal(apart, 0.0)
    radial = np.linalg.lstsq(cubic(apart / dilation), wanted - places @ linear, rcond=None)[0]
    return CardinalFunctions(feature, places, dilation, linear, radial)


def _distances(first: Array, second: Array) -> Array:
    """(F, M) Euclidean distances between rows (F, L) and (M, L)."""
    apart = first[:, None] - second[None]
    return np.asarray(np.sqrt(np.einsum("fml,fml->fm", apart, apart)))
