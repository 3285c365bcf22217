"""Linear equations with symmetric positive definite matrices, many small ones."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray
from scipy.linalg.lapack import dposv

Array = NDArray[np.float64]


def solve_positive(matrices: Array, right: Array) -> Array:
    """(F, W) solutions for ``right`` (F, W) of ``matrices`` (F, W, W), or (1, W, W) where all share
    one. Raises ArithmeticError where one is not positive definite.

    LAPACK's Cholesky solver itself: a frame needs several of these, and NumPy's and SciPy's own
    take longer to check a small matrix than to solve it.
    """
    if len(matrices) == 1:
        return _solved(matrices[0], right.T).T
    solutions = np.empty_like(right)
    for row, matrix in enumerate(matrices):
        solutions[row] = _solved(matrix, right[row])
    return solutions


@njit(cache=True, nogil=True)
def eliminate(matrix: Array, right: Array) -> None:
    """Put the solution of one ``matrix`` (W, W) in the place of ``right`` (W,), for other loops.
    Raises LinAlgError where it is not positive definite."""
    factor = np.linalg.cholesky(matrix)
    for row in range(len(right)):
        right[row] = (right[row] - np.dot(factor[row, :row], right[:row])) / factor[row, row]
    for row in range(len(right) - 1, -1, -1):
        right[row] /= factor[row, row]
        right[:row] -= right[row] * factor[row, :row]


def _solved(matrix: Array, right: Array) -> Array:
    _, solution, failed = dposv(matrix.T, right)
    if failed:
        raise ArithmeticError("a matrix that should be positive definite is not")
    return np.asarray(solution)
