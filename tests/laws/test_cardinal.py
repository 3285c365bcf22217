"""Laws of [B]'s cardinal basis functions, whatever the examples."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mien.mapping.cardinal import fit
from mien.numeric.bspline import cubic


@settings(max_examples=30, deadline=None)
@given(
    seed=st.integers(0, 10_000),
    examples=st.integers(1, 14),
    coordinates=st.integers(1, 40),
    ridge=st.sampled_from([0.0, 5.0, 200.0]),
)
def test_weights_are_one_at_their_example_and_zero_at_all_others_and_at_neutral(
    seed: int, examples: int, coordinates: int, ridge: float
) -> None:
    motion = np.random.default_rng(seed).normal(0, 5, (examples, coordinates))
    weights = fit(motion, np.eye(examples), ridge, threshold=0.0)
    assert np.abs(weights(motion) - np.eye(examples)).max() < 1e-6
    assert np.abs(weights(np.zeros((1, coordinates)))).max() < 1e-9


def test_between_neutral_and_an_example_the_weight_grows_without_a_jump() -> None:
    motion = np.random.default_rng(3).normal(0, 5, (6, 30))
    weights = fit(motion, np.eye(6), ridge=5.0, threshold=0.0)
    way = weights(np.linspace(0, 1, 101)[:, None] * motion[2])[:, 2]
    assert np.abs(np.diff(way)).max() < 0.05
    assert way[50] == pytest.approx(0.5, abs=0.2)


def test_examples_that_cannot_be_told_apart_share_their_weight() -> None:
    motion = np.random.default_rng(4).normal(0, 5, (5, 20))
    motion[4] = motion[3]
    weights = fit(motion, np.eye(5), ridge=1.0, threshold=0.0)(motion[3:4])[0]
    assert weights[3] == pytest.approx(weights[4], abs=1e-6)
    assert 0.2 < weights[3] < 0.8


def test_the_ridge_keeps_noise_from_becoming_large_weights() -> None:
    rng = np.random.default_rng(5)
    smile = rng.normal(0, 4, 40)
    motion = np.stack([smile, smile + rng.normal(0, 0.3, 40)])
    noise = rng.normal(0, 1, (500, 40))
    largest = [np.abs(fit(motion, np.eye(2), r, 0.0)(noise)).max() for r in (0.0, 20.0)]
    assert largest[1] < 0.5 * largest[0]


def test_dropped_eigenvectors_make_the_place_smaller() -> None:
    motion = np.diag([10.0, 5.0, 0.1])
    assert len(fit(motion, np.eye(3), 0.0, threshold=0.0).feature) == 3
    assert len(fit(motion, np.eye(3), 0.0, threshold=0.01).feature) == 2


def test_cubic_b_splines_one_apart_add_up_to_one() -> None:
    inside = np.linspace(0, 1, 50)
    knots = np.arange(-3, 5)
    assert cubic(np.abs(inside[:, None] - knots)).sum(axis=1) == pytest.approx(1.0)
    assert cubic(np.array([0.0, 1.0, 2.0, 9.0])) == pytest.approx([2 / 3, 1 / 6, 0, 0])
