"""What a character acts before a camera is what comes back when the film is captured and mapped."""

from __future__ import annotations

import numpy as np
import pytest

import mien
from mien.capture import CAPTURES, CaptureSettings
from mien.face.pieces import split
from mien.rehearsal import Tempo, film, held, rehearse
from mien.view.camera import Camera

pytest.importorskip("mediapipe", reason="needs the extra 'landmarks'")


@pytest.mark.parametrize("name", ["man", "woman", "monkey"])
def test_the_acted_key_model_has_the_largest_weight(name):
    character = mien.load_character(name)
    acted = rehearse(character, tempo=Tempo(rate=15.0))
    camera = Camera(size=(480, 360))
    performance = CAPTURES["landmarks"](
        film(character, acted, camera), CaptureSettings(), "rehearsal"
    )
    assert not performance.lost.any()
    curves = mien.animate(performance, character, smooth=False)
    pieces = split(character)
    keys = [character.keys.names.index(key) for key in character.examples]
    weights = np.stack([curves.weights[:, pieces.key == key].mean(1) for key in keys], axis=1)
    right = [
        np.argmax(weights[frame]) == row
        for row, key in enumerate(character.examples)
        for frame in held(acted, key)
    ]
    assert np.mean(right) >= 0.9


def test_a_rehearsal_begins_and_ends_at_rest():
    curves = rehearse(mien.load_character("toy"))
    assert (curves.weights[[0, -1]] == 0.0).all()
    np.testing.assert_array_equal(curves.rotation[0], np.eye(3))
    for key in mien.load_character("toy").examples:
        assert len(held(curves, key)) > 5
