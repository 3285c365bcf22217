"""Rotations against SciPy's, near nothing and near half a turn too."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from mien.numeric.rotation import from_vector, to_quaternion, to_vector

SHARE = st.floats(-1.0, 1.0)


@settings(deadline=None)
@given(SHARE, SHARE, SHARE, st.sampled_from([1e-9, 1e-5, 0.1, 1.0, 3.0]))
def test_vectors_and_quaternions_are_scipys(x: float, y: float, z: float, size: float) -> None:
    vector = size * np.array([x, y, z])
    theirs = Rotation.from_rotvec(vector)
    ours = from_vector(vector)
    np.testing.assert_allclose(ours, theirs.as_matrix(), atol=1e-13)
    quaternion = to_quaternion(ours)
    assert abs(quaternion @ theirs.as_quat()) == pytest.approx(1.0, abs=1e-12)
    np.testing.assert_allclose(from_vector(to_vector(ours)), ours, atol=1e-12)


@pytest.mark.parametrize("axis", range(3))
def test_half_a_turn_is_exact(axis: int) -> None:
    half = np.pi * np.eye(3)[axis]
    np.testing.assert_allclose(np.abs(to_vector(from_vector(half))), half, atol=1e-12)


def test_any_shape_of_batch() -> None:
    vectors = np.random.default_rng(0).normal(size=(2, 3, 3))
    whole = from_vector(vectors)
    np.testing.assert_array_equal(whole[1, 2], from_vector(vectors[1, 2]))
    np.testing.assert_array_equal(to_quaternion(whole)[1, 2], to_quaternion(whole[1, 2]))
    assert to_vector(whole[:0]).shape == (0, 3, 3)
