"""Many small quadratic programmes with bounds."""

from __future__ import annotations

import daqp
import numpy as np
from numpy.typing import NDArray

from mien.numeric.pivoting import pivot_each

Array = NDArray[np.float64]

_TOLERANCE = 1e-10
"""By which a bound may be broken before it is clipped: what the free unknowns then are off by."""


def solve_boxes(hessians: Array, linear: Array, lower: Array, upper: Array) -> Array:
    """Minimise x' H x / 2 + f' x under lower <= x <= upper, for each of F problems.

    ``hessians`` (U, W, W), positive definite, with U = F, or U = 1 where all share one;
    ``linear`` (F, W); ``lower``, ``upper`` (W,). Returns (F, W).

    Each problem starts from the active bounds of the one before it, which changes how long it
    takes and nothing else: the minimum is unique. Where all share one matrix daqp factors it once;
    otherwise pivoting takes a fifth of its time where few unknowns are free. Raises ArithmeticError
    where a matrix is not positive definite.
    """
    solutions = np.empty_like(linear)
    if not linear.size:
        return solutions
    hessians = np.ascontiguousarray(hessians, dtype=float)
    linear = np.ascontiguousarray(linear, dtype=float)
    if len(hessians) == len(linear):
        try:
            return pivot_each(hessians, linear, lower, upper)
        except np.linalg.LinAlgError as error:
            raise ArithmeticError("a quadratic programme has no minimum") from error
    model = daqp.Model()
    model.settings = {"primal_tol": _TOLERANCE}
    model.setup(hessians[0], linear[0], np.zeros((0, len(lower))), upper, lower)
    for i, f in enumerate(linear):
        if i:
            model.update(f=f)
        x, _, flag, _ = model.solve()
        if flag < 1:
            raise ArithmeticError(f"daqp stopped with flag {flag}")
        solutions[i] = x
    return np.clip(solutions, lower, upper)


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
    size = len(hessian)
    models = {}
    for neighbours in (1, 2):
        models[neighbours] = daqp.Model()
        stiff = np.ascontiguousarray(hessian + neighbours * coupling * np.eye(size))
        models[neighbours].setup(stiff, linear[0], np.zeros((0, size)), upper, lower)
    stale = np.full(last + 1, np.inf)
    order = 1
    while len(frames := np.flatnonzero(stale > tolerance)):
        for i in frames[::order].tolist():
            beside = x[i - 1] if i == last else x[i + 1] if i == 0 else x[i - 1] + x[i + 1]
            model = models[1 if i in (0, last) else 2]
            model.update(f=linear[i] - coupling * beside)
            new, _, flag, _ = model.solve()
            if flag < 1:
                raise ArithmeticError(f"daqp stopped with flag {flag}")
            stale[max(i - 1, 0) : i + 2] += np.abs(new - x[i]).max()
            stale[i] = 0.0
            x[i] = new
        order = -order
    return np.clip(x, lower, upper)
