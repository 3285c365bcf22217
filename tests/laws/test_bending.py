"""What a displacement costs a plate."""

from __future__ import annotations

import numpy as np
import pytest

from mien.numeric.bending import bending, factor, stiffness


@pytest.fixture
def sheet() -> tuple[np.ndarray, np.ndarray]:
    """A flat sheet of uneven triangles."""
    rng = np.random.default_rng(1)
    x, y = np.meshgrid(np.arange(9.0), np.arange(8.0))
    vertices = np.stack([x.ravel(), y.ravel(), 0.0 * x.ravel()], axis=1)
    vertices[:, :2] += rng.uniform(-0.25, 0.25, (72, 2))
    a = (np.arange(7)[:, None] * 9 + np.arange(8)).ravel()
    triangles = np.concatenate(
        [np.stack([a, a + 1, a + 9], 1), np.stack([a + 1, a + 10, a + 9], 1)]
    )
    return vertices, triangles


def test_area_is_shared_out(sheet: tuple[np.ndarray, np.ndarray]) -> None:
    vertices, triangles = sheet
    weights, area = stiffness(vertices, triangles)
    corners = vertices[triangles]
    whole = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert area.sum() == pytest.approx(0.5 * np.linalg.norm(whole, axis=1).sum())
    assert weights @ np.ones(72) == pytest.approx(np.zeros(72), abs=1e-12)


def test_inside_a_flat_sheet_linear_fields_are_straight(
    sheet: tuple[np.ndarray, np.ndarray],
) -> None:
    vertices, triangles = sheet
    weights, _ = stiffness(vertices, triangles)
    inner = ((vertices[:, :2] > 0.5) & (vertices[:, :2] < [7.5, 6.5])).all(axis=1)
    assert (weights @ vertices)[inner] == pytest.approx(np.zeros((inner.sum(), 3)), abs=1e-9)


def test_bending_is_an_energy_that_knows_no_size(sheet: tuple[np.ndarray, np.ndarray]) -> None:
    vertices, triangles = sheet
    plate = bending(vertices, triangles).toarray()
    assert plate == pytest.approx(plate.T)
    assert np.linalg.eigvalsh(plate).min() > -1e-9
    assert bending(7.0 * vertices, triangles).toarray() == pytest.approx(plate)


def test_the_factor_solves(sheet: tuple[np.ndarray, np.ndarray]) -> None:
    from scipy import sparse

    matrix = bending(*sheet) + sparse.identity(72)
    right = np.random.default_rng(2).normal(size=(72, 3))
    assert matrix @ factor(matrix).solve(right) == pytest.approx(right)
