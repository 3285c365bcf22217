"""A quadratic programme with bounds by block principal pivoting (Kostreva 1978; Júdice and Pires,
Computers and Operations Research 1994).

    H x + f = 0 where x is free,   >= 0 where x is at its lower bound,   <= 0 at its upper

Which unknowns stand at which bound is guessed, the free ones are solved for, and all that turn out
wrong change their place at once. Where that does not lead to fewer wrong ones, the last of them
changes alone, which ends after finitely many steps for every positive definite H. From the bounds
of a neighbouring problem it mostly takes one or two solves, each as large as the free unknowns
are many.
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.numeric.positive import eliminate

Array = NDArray[np.float64]
Sides = NDArray[np.int8]

_TOLERANCE = 1e-11
"""By which an unknown may lie beyond a bound, or still want to leave one, and count as right."""
_PATIENCE = 3
"""Block exchanges that may fail to lessen what is wrong before single ones are made."""
_MOST = 50
"""Exchanges per unknown after which it is given up; far fewer are ever needed."""


@njit(cache=True, nogil=True)
def pivot(hessian: Array, linear: Array, lower: Array, upper: Array, side: Sides) -> Array:
    """Minimise x' H x / 2 + f' x under lower <= x <= upper; (W, W), (W,), (W,), (W,).

    ``side`` (W,) is the guess (-1 at the lower bound, 0 free, 1 at the upper), and what was found
    when it returns. Returns (W,). Raises LinAlgError where H is not positive definite.
    """
    count = len(linear)
    x, wanted = np.empty(count), side.copy()
    fewest, patience = count + 1, _PATIENCE
    for _ in range(_MOST * count + 1):
        _solve_free(hessian, linear, lower, upper, side, x)
        wrong, last = 0, 0
        for i in range(count):
            wanted[i] = _place(hessian, linear, lower, upper, side, x, i)
            if wanted[i] != side[i]:
                wrong, last = wrong + 1, i
        if wrong == 0:
            return np.minimum(np.maximum(x, lower), upper)
        if wrong < fewest or patience > 0:
            patience = _PATIENCE if wrong < fewest else patience - 1
            fewest = min(fewest, wrong)
            side[:] = wanted
        else:
            side[last] = wanted[last]
    raise np.linalg.LinAlgError("no end of exchanges")


@njit(cache=True, nogil=True)
def _place(
    hessian: Array, linear: Array, lower: Array, upper: Array, side: Sides, x: Array, i: int
) -> int:
    """Where unknown ``i`` wants to be."""
    if side[i] == 0:
        if x[i] < lower[i] - _TOLERANCE:
            return -1
        return 1 if x[i] > upper[i] + _TOLERANCE else 0
    step = (np.dot(hessian[i], x) + linear[i]) / hessian[i, i]
    return 0 if step * side[i] > _TOLERANCE else side[i]


@njit(cache=True, nogil=True)
def _solve_free(
    hessian: Array, linear: Array, lower: Array, upper: Array, side: Sides, x: Array
) -> None:
    """Set ``x``: bounds where it stands at one, the minimum over the others."""
    for i in range(len(x)):
        x[i] = 0.0 if side[i] == 0 else (lower[i] if side[i] < 0 else upper[i])
    free = np.flatnonzero(side == 0)
    size = len(free)
    right = np.empty(size)
    for row in range(size):
        right[row] = -linear[free[row]] - np.dot(hessian[free[row]], x)
    if size == 0:
        return
    among = np.empty((size, size))
    for row in range(size):
        for column in range(size):
            among[row, column] = hessian[free[row], free[column]]
    eliminate(among, right)
    for row in range(size):
        x[free[row]] = right[row]


@njit(cache=True, nogil=True)
def pivot_each(hessians: Array, linear: Array, lower: Array, upper: Array) -> Array:
    """(F, W) ``pivot`` of each of ``linear`` (F, W) and ``hessians`` (F, W, W), from where the one
    before it stood; the first from rest."""
    solutions = np.empty_like(linear)
    side = np.zeros(linear.shape[1], dtype=np.int8)
    for i in range(len(side) if len(linear) else 0):
        if lower[i] >= 0.0 and linear[0, i] > 0.0:
            side[i] = -1
        elif upper[i] <= 0.0 and linear[0, i] < 0.0:
            side[i] = 1
    for frame in range(len(linear)):
        solutions[frame] = pivot(hessians[frame], linear[frame], lower, upper, side)
    return solutions
