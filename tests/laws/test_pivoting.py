"""Quadratic programmes with bounds: another's solver, and the conditions of a minimum."""

from __future__ import annotations

import daqp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mien.numeric.pivoting import pivot
from mien.numeric.positive import solve_positive
from mien.numeric.qp import kkt_residual, solve_boxes


def problems(seed: int, count: int, size: int) -> tuple[np.ndarray, np.ndarray]:
    """Hessians (F, W, W) of poorly told unknowns and linear parts (F, W) that wander."""
    rng = np.random.default_rng(seed)
    rows = rng.normal(size=(count, max(size // 2, 1), size))
    hessians = np.swapaxes(rows, 1, 2) @ rows + 0.05 * np.eye(size)
    return hessians, rng.normal(size=size) + np.cumsum(rng.normal(size=(count, size)), axis=0)


def plain(hessian: np.ndarray, linear: np.ndarray, lower: float, upper: float) -> np.ndarray:
    """daqp, which goes another way: a dual active set."""
    size = len(linear)
    box = np.full(size, upper), np.full(size, lower)
    x, _, flag, _ = daqp.solve(hessian, linear, np.zeros((0, size)), *box, primal_tol=1e-12)
    assert flag == 1
    return np.asarray(x)


@settings(deadline=None, max_examples=40)
@given(st.integers(0, 10**6), st.integers(1, 40), st.floats(-2.0, 0.0), st.floats(0.01, 2.0))
def test_each_is_the_minimum(seed: int, size: int, lower: float, upper: float) -> None:
    hessians, linear = problems(seed, 3, size)
    box = np.full(size, lower), np.full(size, upper)
    found = solve_boxes(hessians, linear, *box)
    assert kkt_residual(hessians, linear, found, *box).max() < 1e-8
    for x, hessian, slope in zip(found, hessians, linear, strict=True):
        np.testing.assert_allclose(x, plain(hessian, slope, lower, upper), atol=1e-6)


def test_where_it_starts_changes_nothing() -> None:
    hessians, linear = problems(1, 1, 20)
    lower, upper = np.zeros(20), np.full(20, 0.4)
    found = []
    for guess in (-1, 0, 1):
        side = np.full(20, guess, dtype=np.int8)
        found.append(pivot(hessians[0], linear[0], lower, upper, side))
        np.testing.assert_array_equal(side < 0, found[-1] == 0.0)
    np.testing.assert_allclose(found[1], found[0], atol=1e-9)
    np.testing.assert_allclose(found[2], found[0], atol=1e-9)


def test_bounds_may_be_nowhere() -> None:
    hessians, linear = problems(2, 1, 8)
    nowhere = np.full(8, np.inf)
    free = solve_boxes(hessians, linear, -nowhere, nowhere)
    np.testing.assert_allclose(free[0], np.linalg.solve(hessians[0], -linear[0]), atol=1e-9)


def test_a_valley_without_a_bottom_is_told() -> None:
    with pytest.raises(ArithmeticError, match="no minimum"):
        solve_boxes(-np.eye(3)[None], np.ones((1, 3)), np.full(3, -np.inf), np.full(3, np.inf))


def test_positive_equations_are_solved_or_told() -> None:
    matrices, right = problems(3, 4, 6)
    found = solve_positive(matrices, right)
    np.testing.assert_allclose(np.einsum("fij,fj->fi", matrices, found), right, atol=1e-9)
    shared = solve_positive(matrices[:1], right)
    np.testing.assert_allclose(shared @ matrices[0], right, atol=1e-9)
    with pytest.raises(ArithmeticError, match="positive"):
        solve_positive(-matrices, right)
