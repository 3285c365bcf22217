"""Cloning: nothing is lost on the same mesh, and where a face goes its clone goes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mien.face.character import Character
from mien.face.library import generic_face, load_character
from mien.numeric.rotation import from_vector
from mien.sculpt.cloning import clone


def test_onto_itself_it_is_the_identity(toy_face: Character) -> None:
    motions = toy_face.keys.displacements
    assert clone(toy_face.face, motions, toy_face.face) == pytest.approx(motions, abs=1e-5)


def test_it_commutes_with_turns_and_size(toy_face: Character) -> None:
    face, motions = toy_face.face, toy_face.keys.displacements
    turn = from_vector(np.array([0.3, -0.5, 0.2]))
    moved = replace(face, vertices=1.7 * face.vertices @ turn.T + 12.0)
    assert clone(face, motions, moved) == pytest.approx(1.7 * motions @ turn.T, abs=1e-4)
    same_size = clone(face, motions, moved, size=False)
    assert same_size == pytest.approx(motions @ turn.T, abs=1e-4)


def test_on_the_same_mesh_motion_can_be_kept_as_it_is() -> None:
    generic, man = generic_face(), load_character("man")
    motions = generic.keys.displacements[:3]
    if len(man.face.vertices) != len(generic.face.vertices):
        man = replace(
            generic, face=replace(generic.face, vertices=generic.face.vertices * [1.1, 0.9, 1.0])
        )
    assert clone(generic.face, motions, man.face, turn=False, size=False) == pytest.approx(
        motions, abs=1e-6
    )


def test_another_mesh_moves_alike_and_its_lips_part() -> None:
    generic, woman = generic_face(), load_character("woman")
    keep = generic.keys.names.index("smile"), generic.keys.names.index("jaw_open")
    cut = replace(woman.face, parts=woman.face.parts[:-1], points=woman.face.points)
    smile, jaw = clone(generic.face, generic.keys.displacements[list(keep)], cut)
    points = cut.points
    corner, upper, lower = (points.index([name])[0] for name in ("8.3", "2.2", "2.3"))
    own = generic.face.points.at(generic.keys["jaw_open"].astype(float))
    gap = own[upper, 1] - own[lower, 1]
    assert points.at(smile)[corner, 1] > 2.0
    opened = points.at(jaw)
    assert opened[upper, 1] - opened[lower, 1] > 0.8 * gap
