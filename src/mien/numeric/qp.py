"""Many small quadratic programmes with bounds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.numeric.pivoting import pivot, pivot_each

Array = NDArray[np.float64]


def solve_boxes(hessians: Array, linear: Array, lower: Array, upper: Array) -> Array:
    """Minimise x' H x / 2 + f' x under lower <= x <= upper, for each of F problems.

    ``hessians`` (U, W, W), positive definite, with U = F, or U = 1 where all share one;
    ``linear`` (F, W); ``lower``, ``upper`` (W,). Returns (F, W).

    Each problem starts from the active bounds of the one before it, which changes how long it
    takes and nothing else: the minimum is unique. Raises ArithmeticError where there is none.
    """
    return _found(
        pivot_each(
            np.ascontiguousarray(hessians, dtype=float),
            np.ascontiguousarray(linear, dtype=float),
            np.ascontiguousarray(lower, dtype=float),
            np.ascontiguousarray(upper, dtype=float),
        )
    )


def kkt_residual(
    hessians: Array, linear: Array, solutions: Array, lower: Array, upper: Array
) -> Array:
    """(F,) how far each of ``solutions`` (F, W) is from being the minimum of ``solve_boxes``'
    problem: the largest step, in the unknowns' own unit, that one Jacobi step of projected descent
    would still take. It is 0 exactly where the conditions of Karush, Kuhn and Tucker hold.
    """
    slope = (hessians @ solutions[..., None])[..., 0] + linear
    step = slope / np.einsum("uii->ui", hessians)
    away = solutions - np.clip(solutions - step, lower, upper)
    return np.asarray(np.abs(away).max(axis=1, initial=0.0))


def solve_chain(
    hessian: Array, linear: Array, coupling: float, bounds: tuple[Array, Array], tolerance: float
) -> Array:
    """Minimise sum_f x_f' H x_f / 2 + f_f' x_f + coupling |x_f - x_f-1|^2 / 2 under
    lower <= x_f <= upper.

    ``hessian`` (W, W), positive definite; ``linear`` (F, W); ``bounds`` (W,) each; returns (F, W).
    Block descent along the chain, there and back, each block exact; a block is left alone while
    its neighbours have moved by no more than ``tolerance`` since.
    """
    lower, upper = bounds
    x = solve_boxes(hessian[None], linear, lower, upper)
    last = len(x) - 1
    if last < 1:
        return x
    stiff = [hessian + neighbours * coupling * np.eye(len(hessian)) for neighbours in (1, 2)]
    sides = np.zeros(x.shape, dtype=np.int8)
    stale = np.full(last + 1, np.inf)
    order = 1
    while len(frames := np.flatnonzero(stale > tolerance)):
        for i in frames[::order].tolist():
            beside = x[i - 1] if i == last else x[i + 1] if i == 0 else x[i - 1] + x[i + 1]
            pulled = linear[i] - coupling * beside
            new = _found(pivot(stiff[0 < i < last], pulled, lower, upper, sides[i]))
            stale[max(i - 1, 0) : i + 2] += np.abs(new - x[i]).max()
            stale[i] = 0.0
            x[i] = new
        order = -order
    return x


def _found(solutions: Array) -> Array:
    """``solutions``, if there are any. Raises ArithmeticError."""
    if np.isnan(solutions).any():
        raise ArithmeticError("a quadratic programme has no minimum: its matrix is not positive")
    return solutions
