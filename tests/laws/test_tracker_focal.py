"""A camera's focal length, from landmarks of a head that turns."""

from __future__ import annotations

import numpy as np
import pytest

from mien.capture.landmarks import USUAL_FOCAL
from mien.capture.neutral import ground
from mien.capture.track import KEPT, ROW, LandmarkTrack
from mien.capture.tracker.focal import estimate
from mien.face.library import generic_face
from mien.numeric.rotation import from_vector
from mien.vocabulary.landmarks import IRIS

GROUND = ground(generic_face())
SIZE = (480, 480)
FRONTAL = np.diag([1.0, -1.0, -1.0])


def filmed(focal: float, turn: float) -> LandmarkTrack:
    """The generic face before a camera of ``focal`` pixels, turning by ``turn`` degrees."""
    frames = 90
    random = np.random.default_rng(7)
    depth = focal * 170.0 / 240.0
    swing = np.clip((np.arange(frames) - 15) / 25.0, 0.0, None)
    angles = np.radians(turn) * np.stack(
        [0.5 * np.sin(1.7 * swing), np.sin(2.3 * swing), 0.1 * np.sin(swing)], axis=1
    )
    face = np.zeros((len(KEPT), 3))
    face[: len(GROUND.neutral)] = GROUND.neutral
    face[[ROW[i] for i in IRIS]] = [[31.5, 0.0, 12.0], [-31.5, 0.0, 12.0]]
    points = np.empty((frames, len(KEPT), 3), dtype=np.float32)
    for frame, rotation in enumerate(FRONTAL @ from_vector(angles)):
        seen = face @ rotation.T + [5.0, 10.0, depth]
        pixels = focal * seen[:, :2] / seen[:, 2:] + np.array(SIZE) / 2.0
        points[frame, :, :2] = pixels + random.normal(0.0, 0.3, pixels.shape)
        points[frame, :, 2] = (seen[:, 2] - depth) * focal / depth
    return LandmarkTrack(np.arange(frames) / 30.0, points, np.zeros(frames, dtype=bool), SIZE)


@pytest.mark.parametrize("focal", [400.0, 620.0, 1000.0])
def test_a_turning_head_tells_the_focal_length(focal):
    assert estimate(filmed(focal, 30.0), slice(0, 15), GROUND) == pytest.approx(focal, rel=0.12)


def test_a_still_head_leaves_a_usual_camera():
    usual = USUAL_FOCAL * SIZE[0]
    found = estimate(filmed(1000.0, 0.5), slice(0, 15), GROUND)
    assert abs(np.log(found / usual)) < abs(np.log(1000.0 / usual)) - 0.1
