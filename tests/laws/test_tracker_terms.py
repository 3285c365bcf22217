"""Each term's Jacobian is the slope of its residual; the sum of the terms is solved."""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules

import numpy as np
import pytest

from mien.capture.tracker.landmark_term import LandmarkTerm
from mien.capture.tracker.point_term import PointTerm
from mien.capture.tracker.prior_term import MotionTerm, PriorTerm
from mien.capture.tracker.silhouette_term import SilhouetteTerm
from mien.capture.tracker.solve import WEIGHT_MAX, solve
from mien.capture.tracker.state import Lens, Sites, State
from mien.numeric.gauss_newton import (
    Linearized,
    bounded_step,
    cauchy,
    gather,
    normal_equations,
    tukey,
)
from mien.numeric.rotation import angle_between, from_vector

tracker = import_module("mien.capture.tracker")
POINTS, SHAPES = 20, 4
LENS = Lens(700.0, (320.0, 240.0), 0.8, (100.0, 60.0))


def sites(seed: int = 1) -> Sites:
    random = np.random.default_rng(seed)
    return Sites(
        random.normal(size=(POINTS, 3)) * 40.0, random.normal(size=(SHAPES, POINTS, 3)) * 6.0
    )


def state(seed: int = 2) -> State:
    random = np.random.default_rng(seed)
    turn = from_vector(random.normal(size=3) * 0.2) @ np.diag([1.0, -1.0, -1.0])
    return State(turn, np.array([8.0, -5.0, 600.0]), random.uniform(0.2, 0.8, SHAPES))


def landmark_term() -> LandmarkTerm:
    random = np.random.default_rng(3)
    seen = LENS.project(sites().seen(state())) + random.normal(size=(POINTS, 2))
    return LandmarkTerm(sites(), LENS, seen, random.uniform(0.5, 2.0, POINTS))


def point_term() -> PointTerm:
    seen = LENS.project(sites(5).seen(state())) + 0.7
    return PointTerm(sites(5), LENS, seen, 0.6, 0.3)


def silhouette_term() -> SilhouetteTerm:
    random = np.random.default_rng(6)
    normals = random.normal(size=(POINTS, 2))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    edges = LENS.project(sites(6).seen(state())) + random.normal(size=(POINTS, 2))
    return SilhouetteTerm(sites(6), LENS, normals, edges, 1.3, 0.4)


TERMS = {
    "landmarks": landmark_term(),
    "points": point_term(),
    "silhouette": silhouette_term(),
    "prior": PriorTerm(np.array([0.1, 0.2, 0.3, 0.4])),
    "motion": MotionTerm(state(), 0.02, 3.0, 0.1),
}


@pytest.mark.parametrize("name", TERMS)
def test_a_terms_jacobian_equals_central_differences(name):
    term, here = TERMS[name], state()
    linear = term.linearize(here)
    step = 1e-4
    for column in range(6 + SHAPES):
        change = np.zeros(6 + SHAPES)
        change[column] = step
        ends = [term.linearize(here.moved(sign * change)).residual for sign in (1, -1)]
        slope = (ends[0] - ends[1]) / (2 * step)
        scale = max(1.0, float(np.abs(slope).max()))
        np.testing.assert_allclose(linear.jacobian[:, column], slope, atol=2e-3 * scale)


def test_a_lens_is_a_pinhole():
    places = sites().seen(state())
    plain = LENS.focal * places[:, :2] / places[:, 2:] + np.subtract(LENS.centre, LENS.origin)
    np.testing.assert_allclose(LENS.project(places), LENS.scale * plain)
    np.testing.assert_allclose(LENS.project(places[None]), LENS.scale * plain[None])


def test_no_term_is_left_out():
    """Texture alone has a test of its own: its slope is a mean of two (test_tracker_follow)."""
    modules = {m.name for m in iter_modules(tracker.__path__)}
    tested = {type(term).__module__.rpartition(".")[2] for term in TERMS.values()}
    assert {name for name in modules if name.endswith("_term")} == {*tested, "texture_term"}


def test_the_sums_are_those_of_a_matrix_product():
    random = np.random.default_rng(4)
    jacobian, residual = random.normal(size=(50, 7)), random.normal(size=50)
    weights = random.uniform(0, 1, 50)
    normal, right = np.zeros((7, 7)), np.zeros(7)
    gather(jacobian, residual, weights, normal, right)
    np.testing.assert_allclose(normal, (jacobian * weights[:, None]).T @ jacobian, rtol=1e-10)
    np.testing.assert_allclose(right, -jacobian.T @ (weights * residual), rtol=1e-10)


def test_a_group_of_rows_is_judged_by_its_length():
    term = Linearized(np.array([3.0, 4.0, 0.0, 0.0]), np.zeros((4, 2)), cauchy(5.0), 2.0, group=2)
    np.testing.assert_allclose(term.weights(), [1.0, 1.0, 2.0, 2.0])


@pytest.mark.parametrize("loss", [cauchy(2.0), tukey(3.0)])
def test_far_residuals_count_less(loss):
    weight = loss(np.linspace(0.0, 10.0, 50))
    assert weight[0] == 1.0
    assert (np.diff(weight) <= 0.0).all()
    assert weight[-1] < 0.1


def test_a_step_does_not_press_against_a_bound():
    normal, right = np.eye(2), np.array([-1.0, 1.0])
    step = bounded_step(normal, right, np.zeros(2), np.zeros(2), np.ones(2))
    np.testing.assert_allclose(step, [0.0, 1.0], atol=1e-6)


def test_an_exact_picture_is_solved_within_the_bounds():
    truth = state()
    term = LandmarkTerm(sites(), LENS, LENS.project(sites().seen(truth)), np.full(POINTS, 0.5))
    start = State(
        from_vector(np.array([0.05, -0.04, 0.03])) @ truth.rotation,
        truth.translation + np.array([4.0, 3.0, 20.0]),
        np.zeros(SHAPES),
    )
    found = solve(start, [term], 12)
    assert np.degrees(angle_between(found.rotation, truth.rotation)) < 0.01
    np.testing.assert_allclose(found.weights, truth.weights, atol=1e-3)
    beyond = State(truth.rotation, truth.translation, np.array([2.0, -1.0, 0.5, 0.5]))
    seen = LENS.project(sites().seen(beyond))
    bounded = solve(start, [LandmarkTerm(sites(), LENS, seen, np.full(POINTS, 0.5))], 12)
    assert bounded.weights.min() >= 0.0
    assert bounded.weights.max() <= WEIGHT_MAX


def test_without_terms_there_is_nothing_to_sum():
    normal, right = normal_equations([], 3)
    assert not normal.any()
    assert not right.any()
