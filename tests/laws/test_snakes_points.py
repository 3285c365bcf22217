"""Feature points on curves: where along a curve a point lies, the turn of the head says."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mien.capture.snakes.curves.features import MOUTH, ROW, usual_features, usual_lenses
from mien.capture.snakes.curves.lens import fit_lens, lower_curve, upper_curve
from mien.capture.snakes.head.relief import lifted
from mien.capture.snakes.points import POINTS, places
from mien.numeric.rotation import from_vector

Array = NDArray[np.float64]
ALONG = [POINTS.index(point) for point in ("8.1", "8.2", "8.5", "8.6", "8.7", "8.8")]


def usual() -> Array:
    return np.concatenate([usual_features(), usual_lenses()["mouth"][None]])


def seen_from(turn: Array) -> Array:
    """(MOUTH + 1, 6, 2) the lenses of a usual face under ``turn``, as snakes lay them: even along
    what is seen, for a curve does not tell how it was drawn."""
    edges = [
        lifted(curve(usual(), 41), usual_features()) @ turn[:2].T
        for curve in (upper_curve, lower_curve)
    ]
    return np.stack([fit_lens(upper, lower) for upper, lower in zip(*edges, strict=True)])


def test_a_face_that_looks_ahead_keeps_its_points() -> None:
    assert np.allclose(places(usual(), np.eye(3)), places(usual()))


@pytest.mark.parametrize("degrees", [-25.0, -12.0, 12.0, 25.0])
def test_points_of_the_lips_turn_with_the_head(degrees: float) -> None:
    turn = from_vector(np.array([0.0, np.radians(degrees), 0.0]))
    true = (lifted(places(usual()), usual_features()) @ turn[:2].T)[ALONG]
    lenses = seen_from(turn)
    told = np.abs(places(lenses, turn)[ALONG] - true).mean()
    untold = np.abs(places(lenses)[ALONG] - true).mean()
    assert told < 0.8 * untold


def test_ends_of_curves_stay_with_them_where_the_head_looks_ahead() -> None:
    found = dict(zip(POINTS, places(usual()), strict=True))
    lips = usual()[ROW["lips"]]
    assert np.allclose([found["8.4"], found["8.3"]], lips[:2])
    assert found["2.2"][1] <= found["2.3"][1]
    assert len(usual()) == MOUTH + 1
