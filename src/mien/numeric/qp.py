"""Many small quadratic programmes with bounds."""

from __future__ import annotations

import daqp
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def solve_boxes(hessians: Array, linear: Array, lower: Array, upper: Array) -> Array:
    """Minimise x' H x / 2 + f' x under lower <= x <= upper, for each of F problems.

    ``hessians`` (U, W, W), positive definite, with U = F, or U = 1 where all share one;
    ``linear`` (F, W); ``lower``, ``upper`` (W,). Returns (F, W).

    Each problem starts from the active bounds of the one before it, which changes how long it
    takes and nothing else: the minimum is unique. The solver lives only as long as the call, so
    threads do not meet.
    """
    solutions = np.empty_like(linear)
    if not linear.size:
        return solutions
    hessians = np.ascontiguousarray(hessians, dtype=float)
    linear = np.ascontiguousarray(linear, dtype=float)
    model = daqp.Model()
    model.setup(hessians[0], linear[0], np.zeros((0, len(lower))), upper, lower)
    shared = len(hessians) == 1
    for i, f in enumerate(linear):
        if i and shared:
            model.update(f=f)
        elif i:
            model.update(H=hessians[i], f=f)
        x, _, flag, _ = model.solve()
        if flag < 1:
            raise ArithmeticError(f"daqp stopped with flag {flag}")
        solutions[i] = x
    return np.clip(solutions, lower, upper)


def kkt_residual(
    hessians: Array, linear: Array, lower: Array, upper: Array, solutions: Array
) -> Array:
    """(F,) how far each of ``solutions`` (F, W) is from being the minimum of ``solve_boxes``'
    problem: the largest step, in the unknowns' own unit, that one Jacobi step of projected descent
    would still take. It is 0 exactly where the conditions of Karush, Kuhn and Tucker hold.
    """
    slope = (hessians @ solutions[..., None])[..., 0] + linear
    step = slope / np.einsum("uii->ui", hessians)
    away = solutions - np.clip(solutions - step, lower, upper)
    return np.asarray(np.abs(away).max(axis=1, initial=0.0))
