"""Bounded least squares with smoothness in time: the exact optimum of a blend.

Weights are drawn to those of the frames before and after as a random walk has it:

    sum_f cost_f(w_f) + coupling sum_f |w_f - w_f-1|^2,     0 <= w <= 1

solved frame by frame, each exactly with its neighbours held, there and back until nothing moves.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.mapping.blend import WANDER, Blend
from mien.numeric.qp import solve_boxes, solve_chain

Array = NDArray[np.float64]

_SETTLED = 3e-3
"""Change of a weight that nobody sees."""


def bounded(problem: Blend) -> Array:
    """Weights (F, K) between 0 and 1."""
    size = len(problem.gram)
    lower, upper = np.zeros(size), np.ones(size)
    hessian = problem.with_prior()
    if problem.rate == 0.0:
        return solve_boxes(hessian[None], -problem.onto, lower, upper)
    coupling = problem.rate / WANDER**2
    return solve_chain(hessian, -problem.onto, coupling, (lower, upper), _SETTLED)
