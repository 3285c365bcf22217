"""Yaw, pitch and roll: the inverse of each other, with the signs that are promised."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from mien.numeric.euler import from_euler, to_euler
from mien.numeric.rotation import from_quaternion, from_vector, to_quaternion

turn = st.floats(-3.1, 3.1)
tilt = st.floats(-1.57, 1.57)


@given(turn, tilt, turn)
def test_angles_survive_the_matrix(yaw: float, pitch: float, roll: float) -> None:
    angles = np.array([yaw, pitch, roll])
    np.testing.assert_allclose(to_euler(from_euler(angles)), angles, atol=1e-9)


@given(turn, st.sampled_from([-np.pi / 2, np.pi / 2]), turn)
def test_straight_up_the_rotation_survives_the_angles(
    yaw: float, pitch: float, roll: float
) -> None:
    rotation = from_euler(np.array([yaw, pitch, roll]))
    np.testing.assert_allclose(from_euler(to_euler(rotation)), rotation, atol=1e-7)


def test_positive_is_to_the_own_left_and_up() -> None:
    yaw, pitch, roll = from_euler(np.eye(3) * 0.3)
    assert (yaw @ [0, 0, 1])[0] > 0.2  # the nose goes to the subject's left, +x
    assert (pitch @ [0, 0, 1])[1] > 0.2  # the nose goes up, +y
    assert (roll @ [0, 1, 0])[0] > 0.2  # the crown leans to the left


@given(st.lists(st.floats(-3.0, 3.0), min_size=3, max_size=3), st.floats(0.1, 9.0))
def test_quaternions_of_any_length_are_the_rotation(vector: list[float], length: float) -> None:
    rotation = from_vector(np.array(vector))
    np.testing.assert_allclose(
        from_quaternion(length * to_quaternion(rotation)), rotation, atol=1e-12
    )
