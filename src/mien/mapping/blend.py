"""Blending: what mix of a face's key models shows a motion of feature points.

    min_w  sum_px ((sum_k w_k a_k - m)_px / e_p)^2 + |w|^2 / s^2,     0 <= w <= 1

a_k the motion of key model k and m that of the performer at P points. e_p² is the variance of what
is left: the point's noise and the misfit, what no mix of the key models shows. The misfit is
learnt from the take, so that neither a poor set of faces is believed too far nor a rich one too
little: it weighs the data against the prior, which expects weights of about s. Solvers share this
noun: ``bounded`` and ``genetic``.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

WEIGHT = 0.15
"""Root mean square weight that is expected: most faces rest most of the time."""
WANDER = 1.0
"""Root mean square change of a weight over a second, expected of its random walk."""
_SAMPLE, _ROUNDS = 100, 4
LEAST = 1e-3
"""mm, the misfit is not taken for less: markers are glued to skin that folds."""


@dataclass(frozen=True, slots=True)
class Blend:
    """F frames to be shown by K key models, as inner products in units of e."""

    gram: Array
    """(K, K) among key models."""
    onto: Array
    """(F, K) of the motion with each."""
    square: Array
    """(F,) of the motion with itself."""
    rate: float
    """Frames a second; 0 where frames do not follow each other."""

    def with_prior(self) -> Array:
        """(K, K) ``gram`` and what the prior adds."""
        return self.gram + WEIGHT**-2 * np.eye(len(self.gram))

    def cost(self, weights: Array) -> Array:
        """(F,) the objective at ``weights`` (F, K)."""
        bent = np.einsum("fk,kj,fj->f", weights, self.with_prior(), weights)
        return np.asarray(bent - 2.0 * (weights * self.onto).sum(axis=1) + self.square)


Solver = Callable[[Blend], Array]
"""Weights (F, K) of a blend."""


def blend(fields: Array, motion: Array, variance: Array, rate: float) -> Blend:
    """The blend of key models that move P points by ``fields`` (K, P, 3) to show ``motion``
    (F, P, 3), mm; ``variance`` (P,) is e², mm²."""
    weigh = np.repeat(variance**-0.5, 3)
    known = fields.reshape(len(fields), -1) * weigh
    shown = motion.reshape(len(motion), -1) * weigh
    return Blend(known @ known.T, shown @ known.T, (shown**2).sum(axis=1), rate)


def learn_misfit(fields: Array, motion: Array, noise: Array, solve: Solver) -> float:
    """The misfit's variance, mm²: what ``solve`` leaves of ``motion`` (F, P, 3) beyond ``noise``
    (P,) mm of each point, per coordinate."""
    sample = motion[np.linspace(0, len(motion) - 1, min(_SAMPLE, len(motion))).astype(int)]
    misfit = 1.0
    for _ in range(_ROUNDS):
        weights = solve(blend(fields, sample, noise**2 + misfit, 0.0))
        left = sample - np.tensordot(weights, fields, axes=1)
        misfit = max(float((left**2).mean() - (noise**2).mean()), LEAST**2)
    return misfit
