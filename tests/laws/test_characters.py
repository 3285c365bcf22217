"""Laws every face that is shipped must keep: the generic one and the four characters."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from mien.errors import InputError
from mien.face.character import Character
from mien.face.face import FOLLOWS
from mien.face.library import CHARACTERS, GENERIC, character_file, generic_face, load_character
from mien.numeric.normals import vertex_normals
from mien.sculpt.acting.expressions import EXAMPLES
from mien.sculpt.acting.units import ARKIT
from mien.sculpt.anatomy.cage import LIDS, LIPS, cage
from mien.sculpt.anatomy.skin import labels
from mien.sculpt.anatomy.skull import mean_landmarks
from mien.sculpt.cast import CAST
from mien.vocabulary import fdp, topology

Array = NDArray[np.float64]

ALL = (GENERIC, *CHARACTERS)
WEIGHTS = (0.25, 0.5, 0.75, 1.0)
SKIN = len(cage().fine_mirror)


@pytest.fixture(params=ALL, scope="module")
def character(request: pytest.FixtureRequest) -> Character:
    return load_character(request.param)


def _posed(character: Character, key: str, weight: float = 1.0) -> Array:
    return character.face.vertices + weight * character.keys[key]


def _mirrored(skin: Array) -> Array:
    return skin[cage().fine_mirror] * [-1, 1, 1]


def test_the_skin_comes_first_and_begins_with_the_landmarks(character: Character) -> None:
    skin = character.face.parts[0]
    assert (skin.name, skin.first, skin.last) == ("skin", 0, SKIN)
    assert (skin.triangles == cage().subdivision.triangles).all()
    at = character.face.vertices
    # The subject's left is +x; chin under mouth under nose under brow.
    assert at[263, 0] > at[362, 0] > 0 > at[133, 0] > at[33, 0]
    assert at[152, 1] < at[14, 1] < at[13, 1] + 1 < at[4, 1] < at[168, 1] < at[10, 1]
    assert at[4, 2] > at[234, 2]


def test_the_generic_face_looks_like_the_mean_of_faces() -> None:
    ours, mean = generic_face().face.vertices[: topology.LANDMARKS], mean_landmarks()
    ours, mean = ours - ours.mean(axis=0), mean - mean.mean(axis=0)
    assert np.sqrt(((ours - mean) ** 2).sum(axis=1).mean()) < 7.0


def test_the_origin_lies_midway_between_the_eyes(character: Character) -> None:
    left, right = (character.face.pivots[f"eye_{side}"] for side in ("left", "right"))
    assert np.allclose(left + right, 0)
    assert left[0] > 0
    assert np.allclose(left[1:], 0)


def test_parts_are_carried_by_what_they_belong_to(character: Character) -> None:
    for part in character.face.parts:
        assert part.follows in FOLLOWS
        side = part.name.rpartition("_")[2]
        turns = part.name.split("_")[0] in ("eye", "catch", "socket", "holes", "thread")
        body = part.name in ("bust", "bow")
        assert part.follows == (f"eye_{side}" if turns else "body" if body else "head")
        if part.follows != "head":
            assert not character.keys.displacements[:, part.first : part.last].any()


def test_triangles_stay_in_the_budget_and_face_outwards(character: Character) -> None:
    face = character.face
    assert len(face.triangles) <= 30_000
    assert character_file(character.name).stat().st_size < 1_500_000
    for name in ("eye_left", "eye_right", "bust", "brow_left", "brow_right"):
        part = face.part(name)
        places = face.vertices[part.first : part.last]
        normals = vertex_normals(places, part.triangles - np.int32(part.first))
        middle = face.pivots[name] if name.startswith("eye") else places.mean(axis=0)
        assert ((places - middle) * normals).sum() > 0
    a, b, c = (face.vertices[corner] for corner in face.triangles.T)
    assert (np.linalg.norm(np.cross(b - a, c - a), axis=1) > 1e-9).all()


def test_all_84_points_are_on_the_face(character: Character) -> None:
    points = character.face.points
    assert set(points.ids) == set(fdp.feature_points())
    at = dict(zip(points.ids, points.at(character.face.vertices), strict=True))
    for name, point in fdp.feature_points().items():
        # Teeth have no middle vertex and hair is parted; skin mirrors exactly.
        apart = np.linalg.norm(at[name] - at[point.mirror] * [-1, 1, 1])
        assert apart < (6.0 if name in ("9.8", "9.9", "9.10", "9.11", "11.5") else 1e-4), name
    assert at["3.1"][1] > at["3.3"][1]
    assert at["10.1"][1] > at["10.5"][1]
    assert at["6.1"][2] > at["6.2"][2]
    assert at["11.4"][1] > at["11.1"][1] > at["4.1"][1]
    assert at["11.6"][2] < at["7.1"][2] < at["10.9"][2]


def test_the_skin_is_its_own_mirror_image(character: Character) -> None:
    skin = character.face.vertices[:SKIN]
    assert np.abs(skin - _mirrored(skin)).max() < 1e-6


@pytest.mark.parametrize(("left", "right"), [("blink_left", "blink_right")])
def test_one_eye_blinks_as_the_other(character: Character, left: str, right: str) -> None:
    first, second = character.keys[left][:SKIN], character.keys[right][:SKIN]
    assert np.abs(first - _mirrored(second)).max() < 1e-6
    strength = np.abs(first).max(axis=1)
    assert strength[topology.LID_LOOPS[0]].max() > 10
    assert strength[topology.mirrored(topology.LID_LOOPS[0])].max() < 0.05


def test_every_character_has_the_thirteen() -> None:
    for name in CHARACTERS:
        character = load_character(name)
        assert character.examples == EXAMPLES
        assert set(EXAMPLES) <= set(character.keys.names)
        for key in character.keys.names:
            partner = {"_left": key[:-5] + "_right", "right": key[:-6] + "_left"}.get(key[-5:], key)
            moved, other = character.keys[key][:SKIN], character.keys[partner][:SKIN]
            assert np.abs(moved - _mirrored(other)).max() < 1e-6, key


def test_the_generic_face_speaks_arkit_on_either_side() -> None:
    keys = generic_face().keys
    assert len(ARKIT) == 52
    assert set(ARKIT) <= set(keys.names)
    assert len(generic_face().examples) >= 20
    pairs = [name for name in keys.names if name.endswith(("Left", "_left"))]
    assert len(pairs) >= 22
    for name in pairs:
        other = name.replace("Left", "Right").replace("_left", "_right")
        left, right = keys[name][:SKIN], keys[other][:SKIN]
        assert np.abs(left - _mirrored(right)).max() < 1e-6, name
        if not name.startswith(("jaw", "mouthLeft", "mouth_left")):
            x = generic_face().face.vertices[:SKIN, 0]
            assert (left[x < -5] ** 2).sum() < 0.15 * (left[x > 5] ** 2).sum(), name


def test_skin_stays_clear_of_the_eyeballs(character: Character) -> None:
    label, radius = labels(), CAST[character.name].proportions.eye.radius
    outer = np.flatnonzero((label.lid_inside < 0.02) & (label.mask > 0.9))
    for key in character.keys.names:
        for weight in WEIGHTS:
            skin = _posed(character, key, weight)[outer]
            ahead = skin[:, 2] > 0
            for eye in ("eye_left", "eye_right"):
                distance = np.linalg.norm(skin[ahead] - character.face.pivots[eye], axis=1)
                assert distance.min() > radius - 0.2, (key, weight)


def test_closed_lids_leave_no_gap(character: Character) -> None:
    for side, key in enumerate(("blink_left", "blink_right")):
        skin = _posed(character, key)
        margin = LIDS[side][0]
        upper, lower = skin[margin[1:8]], skin[margin[:8:-1]]
        assert (upper[:, 1] - lower[:, 1]).max() < 0.3


def test_lips_meet_at_rest_and_in_shut_poses(character: Character) -> None:
    upper, lower = LIPS[0][1:10], LIPS[0][:10:-1]
    rest = character.face.vertices
    assert np.abs(rest[upper, 1] - rest[lower, 1]).max() < 0.5
    for key in ("smile", "pressed", "pucker", "sad", "anger"):
        gap = (_posed(character, key)[upper] - _posed(character, key)[lower])[:, 1]
        assert gap.max() < 1.0, key
        assert gap.min() > -1.2, key
    gap = (_posed(character, "jaw_open")[upper] - _posed(character, "jaw_open")[lower])[:, 1]
    assert gap.max() > 25.0


def test_teeth_and_tongue_stay_inside(character: Character) -> None:
    label = labels()
    triangles = character.face.part("skin").triangles
    for key in (None, "smile", "jaw_open", "pressed", "anger", "sad", "pucker"):
        places = character.face.vertices if key is None else _posed(character, key)
        skin = places[:SKIN]
        normals = vertex_normals(np.ascontiguousarray(skin), triangles)
        outside = label.bag < 0.05
        for part in character.face.parts:
            if not part.name.startswith(("teeth", "tongue")):
                continue
            inner = places[part.first : part.last]
            _, near = cKDTree(skin).query(inner)
            through = ((inner - skin[near]) * normals[near]).sum(axis=1)
            assert not (outside[near] & (through > 0.3)).any(), (key, part.name)


def test_key_models_do_what_they_are_called(character: Character) -> None:
    points = character.face.points

    def moved(key: str, point: str) -> Array:
        return np.asarray(points.at(character.keys[key])[points.index([point])[0]])

    assert moved("smile", "8.3")[1] > 4
    assert moved("smile", "8.3")[0] > 3
    assert moved("sad", "8.3")[1] < -3
    assert moved("brows_up", "4.3")[1] > 5
    assert moved("anger", "4.1")[1] < -3
    assert moved("surprise", "4.3")[1] > 5
    assert moved("surprise", "2.1")[1] < -8
    assert moved("jaw_open", "2.1")[1] < -10
    assert moved("pucker", "8.3")[0] < -5
    assert moved("pucker", "8.1")[2] > 3
    assert moved("wide", "8.3")[0] > 3
    assert moved("blink_left", "3.1")[1] < -5
    assert np.abs(moved("blink_left", "3.2")).max() < 0.1
    assert np.abs(moved("pressed", "2.1")).max() < 2


def test_an_unknown_name_is_told_what_there_is() -> None:
    with pytest.raises(InputError, match="man, woman, monkey, toy"):
        load_character("gorilla")
