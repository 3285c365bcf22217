"""The head of the curve capture: its neck, and how deep a face is."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from mien.capture.snakes.curves.features import ROW, usual_features
from mien.capture.snakes.head.flow import steepness
from mien.capture.snakes.head.patch import EYES, HEIGHT, ORIGIN, WIDTH, Placement
from mien.capture.snakes.head.pose import RESTING, Pose
from mien.capture.snakes.head.relief import lifted
from mien.capture.snakes.head.rigid import NECK, Rigid, neck_of, remembered
from mien.numeric.rotation import angle_between, from_vector

Array = NDArray[np.float64]
FEATURES = usual_features()
CORNERS = lifted(FEATURES[[ROW["eye_right"], ROW["eye_left"]], :2].reshape(-1, 2), FEATURES)
NOSE = lifted(np.mgrid[-16:17:8, -8:61:10].reshape(2, -1).T.astype(float), FEATURES)
TURNED = from_vector(np.array([0.05, -0.2, 0.04]))


def degrees(found: Pose) -> float:
    return float(np.degrees(angle_between(found.rotation[None], TURNED[None])[0]))


def fitted(nose: Array, neck: Array) -> Pose:
    """The pose of a head that turned about its neck, whose nose was followed to ``nose``."""
    head, true = (
        Rigid.of(NOSE, np.ones(len(NOSE)), CORNERS),
        Pose(TURNED, 1.0, -(TURNED @ NECK)[:2]),
    )
    seen = np.concatenate([nose, true(CORNERS), neck[None]])
    found = RESTING
    for _ in range(20):
        found = head.pose(seen, found)
    return found


def test_a_head_that_turns_about_its_neck_is_seen_to_turn_though_its_nose_tells_little() -> None:
    true = Pose(TURNED, 1.0, -(TURNED @ NECK)[:2])
    flat = NOSE * np.array([1.0, 1.0, 0.4])
    told = degrees(fitted(true(flat), np.zeros(2)))
    untold = degrees(fitted(true(flat), np.array([1000.0, 1000.0])))
    assert told < 0.75 * untold


def test_a_neck_that_moves_with_the_picture_leaves_the_turn_alone() -> None:
    true = Pose(TURNED, 1.0, -(TURNED @ NECK)[:2])
    assert degrees(fitted(true(NOSE), np.array([60.0, 80.0]))) < 1.0


def test_a_neck_is_remembered_for_some_frames() -> None:
    placement = Placement.at(np.array([[100.0, 120.0], [160.0, 118.0]]), EYES)
    neck, now = neck_of(placement, RESTING), np.array([200.0, 50.0])
    assert np.allclose(placement.to_patch(neck), NECK[:2])
    places = [neck]
    for _ in range(400):
        places.append(remembered(places[-1], now))
    left = np.linalg.norm(np.array(places) - now, axis=1) / np.linalg.norm(neck - now)
    assert left[30] > 0.7
    assert left[400] < 0.02


def test_points_on_smooth_skin_count_little() -> None:
    ramp = 100 + np.arange(WIDTH, dtype=np.uint8) // 10
    anchor = np.tile(ramp, (HEIGHT, 1))
    anchor[:, int(ORIGIN[0]) + 5 :] += 60
    steep = steepness(anchor, np.array([[5.0, 20.0], [-20.0, 20.0], [-20.0, 50.0]]))
    assert steep.mean() == pytest.approx(1.0)
    assert steep[1:].max() < 0.3 * steep[0]


@pytest.mark.parametrize("longer", [0.8, 1.0, 1.25])
def test_a_face_is_as_deep_as_the_generic_one_at_its_own_nostrils_and_mouth(longer: float) -> None:
    stretched = FEATURES * np.array([1.0, longer])
    places = FEATURES[[ROW["nostril_left"], ROW["lips"]]].mean(axis=1)
    own = lifted(places * np.array([1.0, longer]), stretched)
    assert np.allclose(own[:, 2], lifted(places, FEATURES)[:, 2])


def test_lips_lie_before_their_corners() -> None:
    places = np.array([[0.0, 90.0], [0.0, 105.0], [0.0, 120.0]])
    corners = lifted(FEATURES[ROW["lips"], :2], FEATURES)
    assert lifted(places, FEATURES)[:, 2].max() < corners[:, 2].min() - 5.0
