"""Loop's subdivision: where a regular mesh goes when it is subdivided for ever."""

from __future__ import annotations

import numpy as np
import pytest

from mien.numeric.loop import subdivide

SIDE = 7


def grid() -> tuple[np.ndarray, np.ndarray]:
    """Vertices (N, 3) and triangles of a regular grid: inside, every vertex has six neighbours."""
    rows, columns = np.mgrid[0:SIDE, 0:SIDE]
    flat = np.stack([columns + 0.5 * rows, rows * np.sqrt(0.75)], axis=-1).reshape(-1, 2)
    height = np.random.default_rng(4).normal(size=(len(flat), 1))
    corner = (np.arange(SIDE - 1)[:, None] * SIDE + np.arange(SIDE - 1)).ravel()
    first = np.stack([corner, corner + 1, corner + SIDE], axis=1)
    second = np.stack([corner + 1, corner + SIDE + 1, corner + SIDE], axis=1)
    return np.hstack([flat, height]), np.concatenate([first, second])


def test_a_regular_mesh_reaches_its_limit() -> None:
    places, triangles = grid()
    middle = (SIDE // 2) * SIDE + SIDE // 2
    ring = middle + np.array([1, -1, SIDE, -SIDE, SIDE - 1, 1 - SIDE])
    # Loop's limit rule with six neighbours: half of itself, a twelfth of each of them.
    limit = 0.5 * places[middle] + places[ring].sum(axis=0) / 12.0
    distances = []
    for _ in range(5):
        step = subdivide(triangles, len(places))
        places, triangles = step.matrix @ places, step.triangles
        distances.append(np.linalg.norm(places[middle] - limit))
    assert distances[-1] < 1e-3
    # Every step leaves a quarter of what was missing, the second eigenvalue of the rule.
    assert distances[-1] / distances[-2] == pytest.approx(0.25, abs=0.02)


def test_a_plane_stays_plane() -> None:
    places, triangles = grid()
    places[:, 2] = 0.3 * places[:, 0] - 0.7 * places[:, 1]
    step = subdivide(triangles, len(places))
    fine = step.matrix @ places
    np.testing.assert_allclose(fine[:, 2], 0.3 * fine[:, 0] - 0.7 * fine[:, 1], atol=1e-12)
