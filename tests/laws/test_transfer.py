"""Laws of deformation transfer and of what it stands on."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray

from actors import built_in
from faces import toy_character
from mien.errors import InputError
from mien.face.character import KeyModels
from mien.face.face import Face, FeaturePoints, Part
from mien.face.library import generic_face
from mien.numeric.closest import nearest
from mien.numeric.facing import ClosestPoints
from mien.rig.sculpted import sculpted
from mien.sculpt.transfer.artist import follow
from mien.sculpt.transfer.correspondence import correspond
from mien.sculpt.transfer.lips import lips_of, openings
from mien.sculpt.transfer.make import Made, make
from mien.sculpt.transfer.opening import eye_of, see
from mien.sculpt.transfer.outside import outside
from mien.sculpt.transfer.shapes import driven, shape_sets
from mien.sculpt.transfer.skin import skin_of
from mien.sculpt.transfer.solve import Transfer, gradient

Array = NDArray[np.float64]

SHAPES = (
    *("eyeBlinkLeft", "eyeBlinkRight", "mouthSmileLeft", "jawOpen", "browInnerUp"),
    "mouthSmileRight",
)


@cache
def made(name: str) -> Made:
    return make(built_in(name).face, generic_face(), SHAPES, name)


def test_nearest_places_are_the_plain_search_s() -> None:
    face = toy_character().face
    skin = face.part("skin")
    rng = np.random.default_rng(3)
    points = rng.normal(0.0, 60.0, (200, 3))
    found = ClosestPoints(face.vertices, skin.triangles)(points)
    triangle, weights = nearest(points, face.vertices, skin.triangles)
    plain = np.einsum("nc,ncx->nx", weights, face.vertices[skin.triangles[triangle]])
    distance = np.linalg.norm(points - plain, axis=1)
    assert np.abs(found.distance - distance).max() < 1e-6
    assert np.allclose(found.weights.sum(axis=1), 1.0)


def test_what_faces_away_counts_as_farther() -> None:
    sheet = np.array([[0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 1], [0, 9, 1], [9, 0, 1]], float)
    triangles = np.array([[0, 1, 2], [3, 4, 5]], np.int32)
    query, up = np.array([[2.0, 2.0, 0.9]]), np.array([[0.0, 0.0, 1.0]])
    search = ClosestPoints(sheet, triangles)
    assert search(query).triangle[0] == 1
    assert search(query, up, turned=18.0).triangle[0] == 0


def test_gradients_of_a_linear_field_are_its_own_along_the_surface() -> None:
    face = toy_character().face
    skin = face.part("skin")
    slopes, areas = gradient(face.vertices, skin.triangles)
    steep = np.array([0.3, -0.2, 0.5])
    found = (slopes @ (face.vertices @ steep)).reshape(-1, 3)
    a, b, c = (face.vertices[skin.triangles[:, k]] for k in range(3))
    for edge in (b - a, c - a):
        assert np.allclose((found * edge).sum(axis=1), edge @ steep, atol=1e-9)
    assert areas.sum() == pytest.approx(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


def test_seams_are_welded_and_lips_that_touch_are_not() -> None:
    face = toy_character().face
    skin = face.part("skin")
    there = skin.triangles[:40].ravel()
    split = np.concatenate([face.vertices, face.vertices[there]])
    last = len(face.vertices) + np.arange(len(there), dtype=np.int32).reshape(-1, 3)
    torn = replace(skin, last=len(split), triangles=np.concatenate([skin.triangles[40:], last]))
    seamed = replace(face, vertices=split, parts=(torn,))
    assert len(skin_of(seamed).vertices) == len(skin_of(replace(face, parts=(skin,))).vertices)
    # Two sheets back to back at one place, facing away from each other, stay two.
    flipped = np.concatenate([skin.triangles, skin.triangles[:, ::-1] + skin.last])
    twice = np.concatenate([face.vertices[: skin.last], face.vertices[: skin.last]])
    both = replace(face, vertices=twice, parts=(replace(skin, triangles=flipped, last=len(twice)),))
    points = FeaturePoints(
        (*face.points.ids, *face.points.ids),
        np.concatenate([face.points.vertices, face.points.vertices + skin.last]).astype(np.int32),
        np.concatenate([face.points.weights] * 2),
    )
    assert len(skin_of(replace(both, points=points)).vertices) == len(twice)


def test_a_face_transferred_to_itself_keeps_its_shapes() -> None:
    generic = generic_face()
    skin = skin_of(generic.face)
    pair = correspond(generic.face, generic.face, skin, skin)
    rows = [generic.keys.names.index(name) for name in SHAPES]
    motion = skin.gather(generic.keys.displacements[rows])
    moved = Transfer(skin, skin, pair, np.linalg.norm(motion, axis=2).max(axis=0))(motion)
    error = np.linalg.norm(moved - motion, axis=2).mean(axis=1)
    # Gradients are smoothed, which narrow lids feel most.
    assert (error < 0.22 * np.linalg.norm(motion, axis=2).mean(axis=1)).all()


def test_transfer_is_linear() -> None:
    generic, target = generic_face(), built_in("monkey").face
    skin, own = skin_of(generic.face), skin_of(target)
    pair = correspond(generic.face, target, skin, own)
    rows = [generic.keys.names.index(name) for name in SHAPES]
    motion = skin.gather(generic.keys.displacements[rows])
    transfer = Transfer(skin, own, pair, np.linalg.norm(motion, axis=2).max(axis=0))
    one, two = transfer(motion[3:4]), transfer(motion[2:3])
    mixed = transfer(0.3 * motion[3:4] + 0.7 * motion[2:3])
    assert np.abs(mixed - 0.3 * one - 0.7 * two).max() < 1e-9


@pytest.mark.parametrize("name", ["man", "monkey", "toy"])
def test_blinks_shut_the_eye_they_are_of_and_no_other(name: str) -> None:
    face, keys = made(name).character.face, made(name).character.keys
    skin = skin_of(face)
    for blink, shut, open_ in (
        ("eyeBlinkLeft", "eye_left", "eye_right"),
        ("eyeBlinkRight", "eye_right", "eye_left"),
    ):
        posed = skin.vertices + skin.gather(keys[blink])
        for eye, most in ((shut, (0.0, 0.02)), (open_, (0.95, 1.05))):
            rest = see(eye_of(face, eye), skin.vertices, skin.triangles).area
            now = see(eye_of(face, eye), posed, skin.triangles).area
            assert most[0] <= now / rest <= most[1]


@pytest.mark.parametrize("name", ["woman", "toy"])
def test_a_smile_stays_on_its_side_and_a_jaw_falls(name: str) -> None:
    face, keys = made(name).character.face, made(name).character.keys
    left, right = face.points.index(["8.3", "8.4"])
    smile = face.points.at(keys["mouthSmileLeft"])
    assert np.linalg.norm(smile[left]) > 3.0 * np.linalg.norm(smile[right])
    assert smile[left, 1] > 0
    jaw = face.points.at(keys["jawOpen"])
    assert jaw[face.points.index(["2.1"])[0], 1] < -8.0


def test_lower_teeth_turn_with_the_jaw_rigidly_and_upper_ones_stay() -> None:
    face, keys = made("man").character.face, made("man").character.keys
    upper, lower = face.part("teeth_upper"), face.part("teeth_lower")
    jaw = keys["jawOpen"].astype(float)
    assert np.abs(jaw[upper.first : upper.last]).max() == 0.0
    run = face.vertices[lower.first : lower.last]
    moved = run + jaw[lower.first : lower.last]
    assert np.abs(moved - run).max() > 5.0
    before = np.linalg.norm(run[1:] - run[:-1], axis=1)
    assert np.allclose(np.linalg.norm(moved[1:] - moved[:-1], axis=1), before, atol=1e-3)


def test_what_is_inside_the_mouth_is_not_seen_from_outside() -> None:
    face = generic_face().face
    skin = skin_of(face)
    seen = outside(skin.vertices, skin.triangles)
    lips = face.point("2.3")
    deep = (np.abs(skin.vertices - (lips - [0.0, 0.0, 25.0])) < 12.0).all(axis=1)
    assert deep.any()
    assert not seen[deep].any()
    nose = np.linalg.norm(skin.vertices - face.point("9.3"), axis=1).argmin()
    assert seen[nose]


def test_what_an_artist_sculpted_stays() -> None:
    man = built_in("man")
    own = {"jawOpen": man.keys["jaw_open"]}
    found = make(man.face, generic_face(), ("jawOpen", "mouthSmileLeft"), "man", own)
    assert np.array_equal(found.character.keys["jawOpen"], man.keys["jaw_open"])
    assert np.abs(found.character.keys["mouthSmileLeft"]).max() > 1.0


def test_eyes_without_lids_are_told() -> None:
    toy = toy_character().face
    found = make(toy, generic_face(), ("eyeBlinkLeft",), "ball")
    assert any("cannot blink" in note for note in found.notes)
    left = toy.vertices[:, 0] > 1.0
    assert not found.character.keys["eyeBlinkLeft"][left].any()


def test_lips_meet_where_the_source_s_do() -> None:
    man, names = built_in("man").face, ("jawOpen", "mouthClose", "mouthPucker", "mouthRollUpper")
    keys = make(man, generic_face(), names, "man").character.keys
    skin = skin_of(man)
    lips = lips_of(man, skin)
    assert lips is not None
    assert openings(skin, lips).all()
    rest = lips.gaps(skin.vertices[None])[0]
    posed = {name: skin.gather(keys[name]) for name in names}
    assert (lips.gaps((skin.vertices + posed["jawOpen"])[None])[0] > 15.0).all()
    posed["mouthClose"] += posed["jawOpen"]
    for name in names[1:]:
        gap = lips.gaps((skin.vertices + posed[name])[None])[0]
        assert (gap < rest + 0.1).all()
        assert (gap > np.minimum(rest, 0.0) - 0.1).all()


def test_too_few_points_are_an_error() -> None:
    face: Face = toy_character().face
    few = FeaturePoints(face.points.ids[:3], face.points.vertices[:3], face.points.weights[:3])
    with pytest.raises(InputError, match="feature points"):
        make(replace(face, points=few), generic_face(), SHAPES, "toy")


def test_a_made_character_speaks_arkit() -> None:
    sets = shape_sets()
    assert len(sets["arkit"].names) == 52
    character = driven(made("man").character, "arkit")
    assert character.speaks["arkit"]["jawOpen"] == ("jawOpen",)
    assert character.blinks >= {"eyeBlinkLeft"}


def test_the_other_side_follows_what_an_artist_sculpted_of_one() -> None:
    man, smiles = built_in("man"), ("mouthSmileLeft", "mouthSmileRight")
    own = {"mouthSmileLeft": 2.0 * made("man").character.keys["mouthSmileLeft"]}
    keys = make(man.face, generic_face(), smiles, "man", own).character.keys
    assert np.array_equal(keys["mouthSmileLeft"], own["mouthSmileLeft"])
    left, right = (np.linalg.norm(keys[name], axis=1) for name in smiles)
    assert right.max() == pytest.approx(left.max(), rel=0.03)


def test_a_pose_is_understood_and_makes_its_key_models_like_itself() -> None:
    skin = skin_of(built_in("man").face)
    fields = skin.gather(np.stack([made("man").character.keys[name] for name in SHAPES]))
    levels = np.array([0.0, 0.0, 0.6, 0.9, 0.0, 0.0])
    pose = np.tensordot(levels, fields, axes=1)
    same = follow(fields, SHAPES, skin, {}, {"laugh": pose})
    assert np.abs([same.mixtures["laugh"].get(n, 0.0) for n in SHAPES] - levels).max() < 0.1
    assert np.abs(same.made - fields).max() < 0.1 * np.abs(fields).max()
    # An artist who lets the chin fall a third deeper: jawOpen learns it, the brow does not.
    deeper = fields.copy()
    deeper[3] *= 1.0 + np.clip((-40.0 - skin.vertices[:, 1]) / 60.0, 0.0, 1.0)[:, None] / 3.0
    shown = {"laugh": np.tensordot(levels, deeper, axes=1), "ah": deeper[3]}
    found = follow(fields, SHAPES, skin, {}, shown).made
    before, after = (np.linalg.norm(f[3] - deeper[3]) for f in (fields, found))
    assert after < 0.35 * before
    assert np.abs(found[4] - fields[4]).max() < 0.05 * np.abs(fields[4]).max()


def test_a_pose_of_something_else_teaches_nothing() -> None:
    skin = skin_of(built_in("man").face)
    fields = skin.gather(np.stack([made("man").character.keys[name] for name in SHAPES]))
    swollen = 5.0 * np.sign(np.sin(skin.vertices / 3.0))
    found = follow(fields, SHAPES, skin, {}, {"warts": swollen})
    assert not found.mixtures
    assert np.array_equal(found.made, fields)


def test_sculpted_shapes_are_known_by_name_by_spelling_or_by_the_map() -> None:
    man = built_in("man")
    names = ("EyeBlink_L", "laugh", "jaw_open")
    keys = KeyModels(names, np.stack([man.keys[n] for n in ("blink_left", "smile", "jaw_open")]))
    neutral = replace(man, keys=keys, examples=names, meanings={"jaw_open": "jawOpen"})
    found = sculpted(neutral, ("eyeBlinkLeft", "jawOpen", "mouthSmileLeft"))
    assert set(found.own) == {"eyeBlinkLeft", "jawOpen"}
    assert set(found.poses) == {"laugh"}


def test_lips_that_are_sewn_together_are_no_opening() -> None:
    man = built_in("man").face
    skin = skin_of(man)
    lips = lips_of(man, skin)
    assert lips is not None
    upper, lower = lips.nearest()
    seams = np.stack([upper, lower, np.roll(upper, 1)], axis=1)
    sewn = replace(skin, triangles=np.concatenate([skin.triangles, seams.astype(np.int32)]))
    assert not openings(sewn, lips).any()


def test_lashes_longer_than_lids_are_thick_go_with_their_roots() -> None:
    man = built_in("man").face
    skin, lid = skin_of(man), man.points.index(["3.1"])
    root = int(man.points.vertices[lid][0, 0])
    first = len(man.vertices)
    tips = man.vertices[root] + np.array([[0.0, 0.0, 0.0], [-1.0, 0.0, 9.0], [1.0, 0.0, 9.0]])
    corners = np.array([[first, first + 1, first + 2]], np.int32)
    lash = Part("eyelashes", man.part("skin").material, first, first + 3, corners, "head")
    face = replace(
        man,
        vertices=np.concatenate([man.vertices, tips]),
        parts=(*man.parts, lash),
        colours=np.concatenate([man.colours, man.colours[:3]]),
        occlusion=np.concatenate([man.occlusion, man.occlusion[:3]]),
        uv=None,
    )
    assert len(skin_of(face).vertices) == len(skin.vertices)
    blink = make(face, generic_face(), ("eyeBlinkLeft",), "man").character.keys["eyeBlinkLeft"]
    assert np.linalg.norm(blink[root]) > 5.0
    assert np.allclose(blink[first:], blink[root], atol=0.5)
