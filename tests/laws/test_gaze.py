"""Where eyes rest is found from what can be seen of them."""

from __future__ import annotations

import numpy as np
import pytest

from mien.capture.gaze import gaze, gaze_rest
from mien.capture.lids import LidRange, closures


def test_shut_eyes_tell_nothing_of_the_rest() -> None:
    random = np.random.default_rng(0)
    raw = np.full((100, 2, 2), 0.1) + random.normal(0, 0.01, (100, 2, 2))
    closure = np.zeros((100, 2))
    raw[:60, :, 1] -= 0.3
    closure[:60] = 1.0
    rest = gaze_rest(raw, np.zeros((100, 2)), closure)
    np.testing.assert_allclose(rest, 0.1, atol=0.01)


def test_a_take_of_shut_eyes_still_has_a_rest() -> None:
    rest = gaze_rest(np.full((5, 2, 2), 0.2), np.zeros((5, 2)), np.ones((5, 2)))
    np.testing.assert_allclose(rest, 0.2)


def test_a_head_that_stays_turned_looks_back_at_the_camera() -> None:
    turned = np.tile([np.radians(25.0), 0.0], (9, 1))
    rest = gaze_rest(np.zeros((9, 2, 2)), turned, np.zeros((9, 2)))
    np.testing.assert_allclose(rest[:, 0], np.radians(15.0))
    np.testing.assert_allclose(rest[:, 1], 0.0)


def test_eyes_cross_but_never_part() -> None:
    rest, opened = np.zeros((2, 2)), np.zeros((1, 2))
    crossed = gaze(np.array([[[-0.3, 0.0], [0.3, 0.0]]]), rest, opened)[0, :, 0]
    assert crossed[0] < -0.2
    assert crossed[1] > 0.2
    parted = gaze(np.array([[[0.4, 0.0], [-0.2, 0.0]]]), rest, opened)[0, :, 0]
    assert np.allclose(parted, 0.1)


def test_an_eye_half_as_wide_again_as_at_rest_is_no_wider_than_that() -> None:
    span = LidRange(np.array([10.0, 10.0]), np.zeros(2))
    wide = closures(np.array([[15.0, 10.5], [10.0, 5.0]]), span, np.zeros(2))
    assert wide[0] == pytest.approx([-0.5, -0.0208], abs=1e-3)
    assert wide[1, 0] == 0.0
