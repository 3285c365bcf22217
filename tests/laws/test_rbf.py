"""Radial basis functions meet their values, and whatever is affine."""

from __future__ import annotations

import numpy as np
import pytest

from mien.numeric import rbf

KERNELS: tuple[rbf.Kernel, ...] = ("biharmonic", "triharmonic")


@pytest.fixture
def centres() -> np.ndarray:
    return np.random.default_rng(3).uniform(-80.0, 80.0, (40, 3))


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("smoothing", [0.0, 10.0])
def test_affine_maps_are_reproduced(
    centres: np.ndarray, kernel: rbf.Kernel, smoothing: float
) -> None:
    rng = np.random.default_rng(4)
    matrix, shift = rng.normal(size=(3, 3)), rng.normal(size=3)
    elsewhere = rng.uniform(-300.0, 300.0, (50, 3))
    field = rbf.fit(centres, centres @ matrix.T + shift, kernel, smoothing)
    assert field(elsewhere) == pytest.approx(elsewhere @ matrix.T + shift, abs=1e-7)


@pytest.mark.parametrize("kernel", KERNELS)
def test_values_are_met_and_smoothing_misses_the_more_the_larger(
    centres: np.ndarray, kernel: rbf.Kernel
) -> None:
    values = np.random.default_rng(5).normal(size=(40, 2))
    missed = [
        float(np.abs(rbf.fit(centres, values, kernel, smoothing)(centres) - values).max())
        for smoothing in (0.0, 0.01, 1.0)
    ]
    assert missed[0] < 1e-9
    assert 1e-4 < missed[1] < missed[2]


@pytest.mark.parametrize("kernel", KERNELS)
def test_the_matrix_does_what_the_fit_does(centres: np.ndarray, kernel: rbf.Kernel) -> None:
    rng = np.random.default_rng(6)
    values, points = rng.normal(size=(40, 3)), rng.uniform(-100.0, 100.0, (30, 3))
    matrix = rbf.influence(centres, points, kernel, 0.1)
    assert matrix @ values == pytest.approx(rbf.fit(centres, values, kernel, 0.1)(points))


def test_the_size_of_the_world_does_not_matter(centres: np.ndarray) -> None:
    rng = np.random.default_rng(7)
    values, points = rng.normal(size=(40, 3)), rng.uniform(-100.0, 100.0, (30, 3))
    here = rbf.fit(centres, values, "triharmonic", 0.1)(points)
    there = rbf.fit(1e-3 * centres + 5, values, "triharmonic", 0.1)(1e-3 * points + 5)
    assert there == pytest.approx(here)


def test_centres_in_a_plane_are_no_trouble(centres: np.ndarray) -> None:
    flat = centres * [1.0, 1.0, 0.0]
    assert rbf.fit(flat, centres)(flat) == pytest.approx(centres, abs=1e-7)


def test_nonsense_is_refused(centres: np.ndarray) -> None:
    for places, values in (
        (centres, np.zeros((3, 2))),
        (np.zeros((0, 3)), np.zeros((0, 3))),
        (centres, np.full((40, 3), np.nan)),
    ):
        with pytest.raises(ValueError, match=r"values|centres|number"):
            rbf.fit(places, values)
