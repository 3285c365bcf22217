"""The sum of weighted fields against numpy's own product."""

from __future__ import annotations

import numpy as np
import pytest

from mien.numeric.blending import blend


@pytest.mark.parametrize("columns", [0, 1, 2047, 2048, 5000])
def test_a_blend_is_the_matrix_product(columns: int) -> None:
    random = np.random.default_rng(columns)
    fields = random.normal(size=(9, columns)).astype(np.float32)
    weights = random.normal(size=9).astype(np.float32)
    weights[[0, 4, 8]] = 0.0
    np.testing.assert_allclose(blend(weights, fields), weights @ fields, atol=1e-5)


def test_what_does_not_act_is_not_read() -> None:
    fields = np.full((2, 8), np.nan, dtype=np.float32)
    fields[1] = 2.0
    assert np.array_equal(blend(np.array([0.0, 0.5], dtype=np.float32), fields), np.ones(8))
