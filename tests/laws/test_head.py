"""A character's head stands where the performer's does."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import mien
from mien.face.animate import Poser
from mien.face.pieces import split
from mien.numeric.rotation import from_vector
from mien.performance.performance import Performance
from mien.vocabulary.landmarks import feature_points


def test_the_point_between_the_eyes_goes_where_the_performers_went():
    character = mien.load_character("woman")
    points = tuple(fdp for fdp in feature_points() if fdp in character.face.points.ids)
    turn = from_vector(np.array([[0.1, 0.4, -0.2], [0.0, 0.0, 0.0]]))
    step = np.array([[12.0, -7.0, 30.0], [0.0, 0.0, 0.0]])
    rows = character.face.points.index(points)
    performance = Performance(
        points=points,
        neutral=character.face.points.at(character.face.vertices)[rows],
        time=np.array([0.0, 0.1]),
        motion=np.zeros((2, len(points), 3)),
        sigma=np.ones((len(points), 3)),
        rotation=turn,
        translation=step,
        gaze=np.zeros((2, 2, 2)),
        confidence=np.ones(2),
        lost=np.zeros(2, dtype=bool),
        unseen=np.zeros((2, 3)),
    )
    curves = mien.animate(performance, character, smooth=False)
    poser = Poser(character.face, split(character))
    skin = character.face.part("skin")
    rest = character.face.vertices[skin.first : skin.last]
    posed = poser.at(curves, 0)[skin.first : skin.last]
    np.testing.assert_allclose(posed, rest @ turn[0].T + step[0], atol=1e-6)
    elsewhere = replace(performance, rest_translation=step[0], rest_rotation=turn[0])
    still = poser.at(mien.animate(elsewhere, character, smooth=False), 0)
    np.testing.assert_allclose(still, character.face.vertices, atol=1e-6)
