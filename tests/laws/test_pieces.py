"""Laws of splitting key models into brow, eyes and mouth, left and right."""

from __future__ import annotations

import numpy as np
import pytest

from actors import built_in
from mien.face.character import BLINKS, Character
from mien.face.library import CHARACTERS, GENERIC
from mien.face.pieces import Pieces, region_masks, shares, side_masks, split


@pytest.fixture(params=CHARACTERS, scope="module")
def character(request: pytest.FixtureRequest) -> Character:
    return built_in(request.param)


@pytest.fixture(scope="module")
def pieces(character: Character) -> Pieces:
    return split(character)


def test_pieces_add_up_to_their_key_model(character: Character, pieces: Pieces) -> None:
    for name in character.examples:
        key = character.keys.names.index(name)
        total = pieces.displacements[pieces.key == key].sum(axis=0)
        assert np.abs(total - character.keys.displacements[key]).max() < 1e-4
        assert (pieces.cells[pieces.key == key].sum(axis=0) == 1).all()


def test_names_are_unique_and_mirror_onto_each_other(pieces: Pieces) -> None:
    partner = pieces.mirrored()
    assert len(set(pieces.names)) == len(pieces.names)
    assert (partner[partner] == np.arange(len(partner))).all()
    assert (pieces.side[partner] == np.choose(pieces.side + 1, [-1, 1, 0])).all()
    assert (pieces.cells[partner] == pieces.cells[..., ::-1]).all()


def test_a_smile_and_a_smile_of_the_left_have_pieces_of_their_own() -> None:
    names = split(built_in(GENERIC)).names
    assert len(set(names)) == len(names)


def test_a_lid_and_a_jaw_are_not_cut(character: Character, pieces: Pieces) -> None:
    names = [character.keys.names[key] for key in pieces.key]
    for name in BLINKS & set(names):
        assert names.count(name) == 1
    assert names.count("jaw_open") == 1
    assert {"blink_L", "blink_R", "jaw_open"} <= set(pieces.names)


def test_a_brow_piece_leaves_the_mouth_alone(character: Character, pieces: Pieces) -> None:
    mouth = character.face.points.index(["8.1", "8.2", "8.3", "8.4", "2.1"])
    motion = character.face.points.at(pieces.displacements.astype(float))[:, mouth]
    raised = [i for i, name in enumerate(pieces.names) if "_brow_" in name]
    assert raised
    assert np.abs(motion[raised]).max() < 0.05


def test_a_left_piece_leaves_the_right_alone(character: Character, pieces: Pieces) -> None:
    right = character.face.points.index(["8.4", "3.2", "3.12", "4.6", "5.2"])
    motion = character.face.points.at(pieces.displacements.astype(float))[:, right]
    assert np.abs(motion[pieces.side == 0]).max() < 0.3


def test_masks_share_everything_out(character: Character) -> None:
    face = character.face
    places = np.random.default_rng(0).uniform(-120, 120, (500, 3))
    regions, sides = region_masks(face, places), side_masks(face, places)
    assert regions.sum(axis=0) == pytest.approx(1.0)
    assert sides.sum(axis=0) == pytest.approx(1.0)
    assert min(regions.min(), sides.min()) > -1e-12
    every = np.eye(6, dtype=bool).reshape(6, 3, 2)
    assert shares(every, regions, sides).sum(axis=0) == pytest.approx(1.0)


def test_any_face_splits(toy_face: Character) -> None:
    pieces = split(toy_face)
    total = pieces.displacements.sum(axis=0)
    assert np.abs(total - toy_face.keys.displacements.sum(axis=0)).max() < 1e-4
    assert "blink_L" in pieces.names
