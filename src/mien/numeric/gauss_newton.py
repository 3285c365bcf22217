"""Robust Gauss-Newton over terms that each bring a residual and its Jacobian.

    minimise  sum over terms of weight * rho(|r|),    J' W J step = -J' W r

W are the weights of iteratively reweighted least squares; the robust loss and the weight of a term
belong to the solver, a term knows its residual alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]
Loss = Callable[[Array], Array]
"""Size of a residual (R,) in its own standard errors -> weight (R,) of least squares."""


def cauchy(knee: float) -> Loss:
    """Weights 1 / (1 + (r / knee)²): far residuals count little, and never nothing."""
    return lambda size: 1.0 / (1.0 + (size / knee) ** 2)


def tukey(knee: float) -> Loss:
    """Weights (1 - (r / knee)²)², none beyond the knee."""
    return lambda size: np.clip(1.0 - (size / knee) ** 2, 0.0, None) ** 2


def quadratic(size: Array) -> Array:
    """No robustness."""
    return np.ones_like(size)


@dataclass(frozen=True, slots=True)
class Linearized:
    """One term about the present state: r (R,) in standard errors and J (R, U)."""

    residual: Array
    jacobian: Array
    loss: Loss = quadratic
    weight: float = 1.0
    group: int = 1
    """Consecutive rows that are one observation and are judged by their length."""

    def weights(self) -> Array:
        """(R,) of least squares."""
        if self.loss is quadratic:
            return np.full(len(self.residual), self.weight)
        if self.group == 1:
            return self.weight * self.loss(np.abs(self.residual))
        size = np.linalg.norm(self.residual.reshape(-1, self.group), axis=1)
        return np.repeat(self.weight * self.loss(size), self.group)


def normal_equations(terms: Iterable[Linearized], unknowns: int) -> tuple[Array, Array]:
    """J' W J (U, U) and -J' W r (U,) summed over ``terms``."""
    normal, right = np.zeros((unknowns, unknowns)), np.zeros(unknowns)
    for term in terms:
        gather(term.jacobian, term.residual, term.weights(), normal, right)
    return normal, right


_ROWS = 4
"""Rows summed at once: a sum is fetched and put back a quarter as often."""


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def gather(jacobian: Array, residual: Array, weights: Array, normal: Array, right: Array) -> None:
    """Add J' W J to ``normal`` (U, U) and -J' W r to ``right`` (U,).

    A matrix product does the same, and hands two thousand rows to as many threads as there are
    cores: where others are at work, their waiting takes ten times as long as the sums.
    """
    rows, unknowns = jacobian.shape
    half = np.zeros((unknowns, unknowns))
    slope, heavy = np.zeros((2, _ROWS, unknowns))
    for first in range(0, rows, _ROWS):
        for k in range(_ROWS):
            row = min(first + k, rows - 1)
            weight = weights[row] if row == first + k else 0.0
            for i in range(unknowns):
                slope[k, i] = jacobian[row, i]
                heavy[k, i] = weight * jacobian[row, i]
                right[i] -= heavy[k, i] * residual[row]
        for i in range(unknowns):
            a, b, c, d = heavy[0, i], heavy[1, i], heavy[2, i], heavy[3, i]
            for j in range(i, unknowns):
                half[i, j] += a * slope[0, j] + b * slope[1, j] + c * slope[2, j] + d * slope[3, j]
    for i in range(unknowns):
        normal[i, i] += half[i, i]
        for j in range(i + 1, unknowns):
            normal[i, j] += half[i, j]
            normal[j, i] += half[i, j]


def bounded_step(normal: Array, right: Array, value: Array, least: Array, most: Array) -> Array:
    """(U,) the step of least squares from ``value`` (U,) that presses against no bound it rests
    on; what the step carries beyond a bound is for the caller to clip."""
    pressed = ((value <= least) & (right < 0.0)) | ((value >= most) & (right > 0.0))
    held = normal.copy()
    held[np.diag_indices(len(held))] += 1e9 * pressed
    return np.asarray(np.linalg.solve(held, right))
