"""Laws of wires."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from actors import built_in, shown
from mien.errors import FormatError
from mien.face.library import CHARACTERS
from mien.face.targets import targets
from mien.face.wires import control_motion, wire_pieces, wires_of, with_moved_wires
from mien.formats.notes.wires import read_wires, write_wires
from mien.mapping import MAPPERS, Settings


@pytest.mark.parametrize("name", CHARACTERS)
def test_all_wires_of_a_key_model_give_it_back(name: str) -> None:
    character = built_in(name)
    pieces = wire_pieces(character)
    for example in character.examples:
        key = character.keys.names.index(example)
        total = pieces.displacements[pieces.key == key].sum(axis=0, dtype=float)
        assert np.abs(total - character.keys.displacements[key]).max() < 1e-6


def test_shares_are_a_partition_and_follow_their_own_points() -> None:
    character = built_in("woman")
    wires, face = wires_of(character), character.face
    assert np.allclose(wires.share.sum(axis=0), 1.0, atol=1e-5)
    for wire, ids in enumerate(wires.points):
        for fdp in ids:
            at = face.points.index([fdp])[0]
            near = face.points.vertices[at][face.points.weights[at].argmax()]
            assert wires.share[:, near].argmax() == wire, (wires.names[wire], fdp)


def test_one_wire_moves_its_own_part_of_the_face() -> None:
    character = built_in("man")
    pieces, face = wire_pieces(character), character.face
    brow = pieces.displacements[pieces.names.index("surprise@brow_left")]
    at = face.points.at(brow)
    left, right, chin = face.points.index(["4.3", "4.4", "2.1"])
    assert np.linalg.norm(at[left]) > 20.0 * np.linalg.norm(at[right])
    assert np.linalg.norm(at[left]) > 20.0 * np.linalg.norm(at[chin])


def test_half_a_smile_is_shown_by_half_the_wires() -> None:
    character = built_in("woman")
    performance = shown(character, np.eye(len(character.examples)))
    row = character.examples.index("smile")
    left = character.face.points.index(performance.points)
    keep = character.face.points.at(character.face.vertices)[left, 0] > 1.0
    performance.motion[row][~keep] = 0.0
    curves = MAPPERS["wires"](character, performance, Settings())(performance)
    weights = dict(zip(curves.names, curves.weights[row], strict=True))
    smile = {name: w for name, w in weights.items() if name.startswith("smile@upper_lip_")}
    assert smile["smile@upper_lip_left"] > 0.5
    assert smile["smile@upper_lip_right"] < 0.3


def test_curves_over_wires_find_their_targets() -> None:
    character = built_in("toy")
    performance = shown(character, np.eye(len(character.examples)))
    curves = MAPPERS["wires"](character, performance, Settings())(performance)
    assert targets(character, curves.names).displacements.shape[0] == len(curves.names)


def test_a_dragged_control_point_takes_the_skin_along_and_nothing_far() -> None:
    character = built_in("woman")
    before = control_motion(character, "smile")
    moved = with_moved_wires(character, "smile", {"8.3": before["8.3"] + [0.0, 5.0, 0.0]})
    change = character.face.points.at(moved.keys["smile"]) - character.face.points.at(
        character.keys["smile"]
    )
    corner, brow = character.face.points.index(["8.3", "4.3"])
    assert change[corner, 1] > 2.5
    assert np.abs(change[brow]).max() < 0.05
    assert np.array_equal(moved.keys["anger"], character.keys["anger"])


def test_wires_that_stay_change_nothing() -> None:
    character = built_in("toy")
    same = with_moved_wires(character, "sad", control_motion(character, "sad"))
    assert np.abs(same.keys["sad"] - character.keys["sad"]).max() < 1e-6


def test_wires_in_a_file_come_back(tmp_path: Path) -> None:
    character = built_in("man")
    wired = {key: control_motion(character, key) for key in ("smile", "anger")}
    write_wires(tmp_path / "w.toml", wired)
    found = read_wires(tmp_path / "w.toml")
    for key, points in wired.items():
        for fdp, moved in points.items():
            assert np.abs(found[key][fdp] - moved).max() < 1e-3


@pytest.mark.parametrize(
    "text", ["smile = 3", '[smile]\n"8.3" = [1, 2]', '[smile]\n"8.3" = [1, nan, 2]', "[[", "\x00"]
)
def test_broken_wire_files_are_told(tmp_path: Path, text: str) -> None:
    path = tmp_path / "w.toml"
    path.write_text(text)
    with pytest.raises(FormatError, match=r"w\.toml"):
        read_wires(path)
