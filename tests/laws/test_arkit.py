"""Laws of the ARKit vocabulary as a performance and as a result."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mien.capture.shapes import motion_from_shapes
from mien.face.library import generic_face
from mien.mapping.arkit import arkit_weights
from mien.performance.performance import Performance
from mien.vocabulary.arkit import names


def spoken(weights: np.ndarray) -> Performance:
    """A recorded take of ARKit weights (F, 52) with a still head."""
    frames = len(weights)
    return Performance(
        points=(),
        neutral=np.zeros((0, 3)),
        time=np.arange(frames) / 60.0,
        motion=np.zeros((frames, 0, 3)),
        sigma=np.zeros((0, 3)),
        rotation=np.tile(np.eye(3), (frames, 1, 1)),
        translation=np.zeros((frames, 3)),
        gaze=np.zeros((frames, 2, 2)),
        confidence=np.ones(frames),
        lost=np.zeros(frames, dtype=bool),
        unseen=np.zeros((frames, 3)),
        vocabulary="arkit",
        shapes=weights,
    )


def one_hot(*chosen: str) -> np.ndarray:
    weights = np.zeros((len(chosen), len(names())))
    for frame, name in enumerate(chosen):
        weights[frame, names().index(name)] = 1.0
    return weights


def test_a_take_that_speaks_arkit_passes_unchanged():
    weights = np.random.default_rng(1).uniform(0, 1, (5, 52))
    np.testing.assert_array_equal(arkit_weights(spoken(weights), generic_face()), weights)


def test_no_weights_are_no_motion():
    performance = motion_from_shapes(spoken(np.zeros((3, 52))), generic_face())
    assert (performance.motion == 0.0).all()
    weights = arkit_weights(replace(performance, vocabulary=""), generic_face())
    np.testing.assert_allclose(weights, 0.0, atol=1e-9)


@pytest.mark.parametrize(
    "name", ["jawOpen", "mouthSmileLeft", "mouthFrownRight", "browInnerUp", "mouthFunnel"]
)
def test_a_shape_comes_back_as_the_largest_weight(name):
    performance = replace(motion_from_shapes(spoken(one_hot(name)), generic_face()), vocabulary="")
    weights = arkit_weights(performance, generic_face())[0]
    assert names()[int(np.argmax(weights))] == name
    assert weights[names().index(name)] > 0.5


def test_a_blink_is_told_by_the_lid_of_its_eye():
    performance = replace(
        motion_from_shapes(spoken(one_hot("eyeBlinkRight")), generic_face()), vocabulary=""
    )
    weights = dict(zip(names(), arkit_weights(performance, generic_face())[0], strict=True))
    assert weights["eyeBlinkRight"] == 1.0
    assert weights["eyeBlinkLeft"] == 0.0


def test_a_look_to_the_left_turns_one_eye_in_and_the_other_out():
    performance = motion_from_shapes(spoken(np.zeros((1, 52))), generic_face())
    performance = replace(performance, vocabulary="", gaze=np.full((1, 2, 2), [0.3, 0.0]))
    weights = dict(zip(names(), arkit_weights(performance, generic_face())[0], strict=True))
    assert weights["eyeLookOutLeft"] > 0.4
    assert weights["eyeLookInRight"] > 0.4
    assert weights["eyeLookInLeft"] == weights["eyeLookOutRight"] == 0.0


def test_another_vocabulary_is_refused():
    with pytest.raises(ValueError, match="klingon"):
        motion_from_shapes(replace(spoken(np.zeros((1, 52))), vocabulary="klingon"), generic_face())
