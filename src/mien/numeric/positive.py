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


@njit(cache=True, nogil=True, fastmath={"reassoc"})
def eliminate(matrix: Array, right: Array) -> None:
    """Put the solution of one ``matrix`` (W, W), which is used up, in the place of ``right`` (W,),
    for other loops. Raises LinAlgError where it is not positive definite.

    Cholesky in loops alone: what NumPy does for a kernel takes numba seconds to compile.
    """
    size = len(right)
    for i in range(size):
        for j in range(i + 1):
            left = matrix[i, j]
            for k in range(j):
                left -= matrix[i, k] * matrix[j, k]
            if j < i:
                matrix[i, j] = left / matrix[j, j]
            elif left > 0.0:
                matrix[i, i] = np.sqrt(left)
            else:
                raise np.linalg.LinAlgError("Matrix is not positive definite.")
    for i in range(size):
        for k in range(i):
            right[i] -= matrix[i, k] * right[k]
        right[i] /= matrix[i, i]
    for i in range(size - 1, -1, -1):
        right[i] /= matrix[i, i]
        for k in range(i):
            right[k] -= right[i] * matrix[i, k]


def _solved(matrix: Array, right: Array) -> Array:
    _, solution, failed = dposv(matrix.T, right)
    if failed:
        raise ArithmeticError("a matrix that should be positive definite is not")
    return np.asarray(solution)
