"""Laws of finding a face on a mesh: nearest points, eyeballs, margins, lips, what looks wrong."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from guests import PICKS, SHAPES, edited, guest, write_guest
from mien.face.model import Hooks, Model
from mien.formats.gltf.read import read_gltf
from mien.numeric.closest import closest_on_triangles, nearest
from mien.rig.acts import measure, unexpressed
from mien.rig.build import build
from mien.rig.components import components, find_ball, round_pair
from mien.rig.doubts import doubts
from mien.rig.importer import import_character
from mien.rig.picks import Picks, read_picks
from mien.rig.settle import settle
from mien.rig.spoken import plain, side_of


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> tuple[Model, Picks]:
    path, points = write_guest(tmp_path_factory.mktemp("rig"))
    return read_gltf(path), read_picks(points)


def test_no_point_of_a_triangle_is_nearer() -> None:
    rng = np.random.default_rng(0)
    points, a, b, c = rng.normal(size=(4, 200, 3))
    weights = closest_on_triangles(points, a, b, c)
    assert (weights > -1e-12).all()
    assert np.allclose(weights.sum(axis=1), 1.0)
    found = weights[:, :1] * a + weights[:, 1:2] * b + weights[:, 2:] * c
    best = np.linalg.norm(found - points, axis=1)
    for share in rng.dirichlet(np.ones(3), 500):
        other = np.linalg.norm(share @ np.stack([a, b, c]).transpose(1, 0, 2) - points, axis=1)
        assert (best <= other + 1e-9).all()


def test_points_of_a_mesh_are_their_own_nearest() -> None:
    face = guest().face
    triangles = face.part("skin").triangles
    rng = np.random.default_rng(1)
    chosen = rng.choice(len(triangles), 50)
    weights = rng.dirichlet(np.ones(3), 50)
    places = np.einsum("nk,nkx->nx", weights, face.vertices[triangles[chosen]])
    triangle, found = nearest(places, face.vertices, triangles)
    again = np.einsum("nk,nkx->nx", found, face.vertices[triangles[triangle]])
    assert np.abs(again - places).max() < 1e-9


def test_eyeballs_are_told_from_lashes_and_teeth() -> None:
    face = guest().face
    part = components(face.vertices, face.triangles)
    for side, eye in enumerate(("eye_left", "eye_right")):
        corners = (("3.7", "3.11", "3.1", "3.3"), ("3.12", "3.8", "3.2", "3.4"))[side]
        lids = np.stack([face.point(fdp) for fdp in corners])
        ball = find_ball(face.vertices, part, lids)
        assert ball is not None
        assert np.allclose(ball.centre, face.pivots[eye], atol=0.5)
        own = face.part(eye)
        assert ball.vertices[own.first : own.last].all()
        for lash in ("lash_left", "lash_right", "teeth_upper", "skin"):
            run = face.part(lash)
            assert not ball.vertices[run.first : run.last].any(), lash
    pair = round_pair(face.vertices, part)
    assert sorted(round(ball.centre[0]) for ball in pair) == [-32, 32]


def test_lids_and_lips_settle_where_looking_cannot_tell(model: tuple[Model, Picks]) -> None:
    read, picks = model
    # What was seen of a shut mouth and of narrow lids: one place for both.
    blurred = dict(picks)
    blurred["2.2"] = blurred["2.3"] = (picks["2.2"] + picks["2.3"]) / 2.0
    for fdp in ("3.1", "3.3"):
        blurred[fdp] = picks[fdp] + [0.0, 0.002, 0.0]
    character = build(read, blurred, 1000.0, seen=True)
    acts = {act.name: act for act in measure(character)}
    assert acts["eyeBlinkLeft"].shuts[0] == pytest.approx(1.0, abs=0.25)
    points = character.face.points
    opened = points.at(character.keys["jawOpen"])
    upper, lower = points.index(("2.2", "2.3"))
    assert opened[upper, 1] - opened[lower, 1] > 15.0


def test_the_other_way_round_is_the_same_face(tmp_path: Path) -> None:
    path, points = write_guest(tmp_path)
    ahead = import_character(path, points=points).character
    edited(path, lambda told: told["nodes"][1].update(rotation=[0, 1, 0, 0]))
    turned = [f'"{n}" = {(guest().face.point(n) / [-1e3, 1e3, -1e3]).tolist()}' for n in PICKS]
    points.write_text("[points]\n" + "\n".join(turned))
    found = import_character(path, points=points)
    assert found.facing == -1
    assert np.abs(found.character.face.vertices - ahead.face.vertices).max() < 0.01
    assert {act.name: act.side for act in found.acts}["eyeBlinkLeft"] == "left"
    assert "faces -z: turned round" in doubts(found, read_gltf(path))


def test_what_looks_wrong_is_said(tmp_path: Path) -> None:
    silent = tuple(name for name in SHAPES if name != "jawOpen" and "eye" not in name)
    path, points = write_guest(tmp_path, silent)
    told = " ".join(doubts(import_character(path, points=points), read_gltf(path)))
    assert "no shape parts the lips" in told
    assert "shut one eye each" in told
    bare = replace(read_gltf(path), shapes=())
    character = build(bare, read_picks(points), 1000.0)
    assert not character.keys.names
    found = import_character(path, points=points)
    assert found.character.origin is not None
    origin = replace(found.character.origin, hooks=Hooks(0, (None, None)))
    unturned = replace(found, character=replace(found.character, origin=origin))
    assert any("turn the eyes" in line for line in doubts(unturned, read_gltf(path)))


def test_what_no_shape_expresses_is_said(tmp_path: Path) -> None:
    path, points = write_guest(tmp_path)
    lost = unexpressed(import_character(path, points=points).character)
    assert not set(lost) & set(SHAPES)
    assert {"cheekPuff", "jawLeft", "mouthFrownRight"} <= set(lost)


def test_spellings_of_arkit_are_one() -> None:
    for name in (
        "eyeBlinkLeft",
        "EyeBlinkLeft",
        "eyeBlink_L",
        "face.eye_blink_l",
        "EYE_BLINK_LEFT",
    ):
        assert plain(name) == "eyeblinkleft", name
    assert [side_of(n) for n in ("eyeBlink_L", "mouthRight", "jawOpen", "left_to_right")] == [
        *("left", "right"),
        *("", ""),
    ]


def test_a_brow_lies_where_its_shape_lifts_it() -> None:
    """A point that looking put beside the brow goes to the peak close by, and no farther."""
    places = {
        name: np.array(place, float)
        for name, place in {
            "4.1": (10, 20, 0), "4.3": (25, 24, 0), "4.5": (40, 20, 0),
            "3.7": (40, 0, 0), "3.11": (10, 0, 0),
        }.items()
    }  # fmt: skip
    vertices = np.array([*places.values(), (12, 28, 0), (25, 60, 0)], float)
    fields = np.zeros((2, len(vertices), 3), np.float32)
    fields[0, 5, 1], fields[1, 6, 1] = 5.0, 5.0
    found = settle(places, vertices, fields, lids=False)
    assert found["4.1"].tolist() == [12, 28, 0]
    assert found["4.3"].tolist() == [25, 24, 0]
    assert settle(places, vertices, fields, lids=False, sure=("4.1",))["4.1"].tolist() == [
        10,
        20,
        0,
    ]


def test_triangles_that_meet_in_no_surface_are_spoken_of(tmp_path: Path) -> None:
    path, points = write_guest(tmp_path)
    model, found = read_gltf(path), import_character(path, points=points)
    assert not any("clean surface" in line for line in doubts(found, model))
    skin = model.parts[0]
    fins = skin.triangles[:2000].copy()
    fins[:, 2] = np.random.default_rng(3).integers(0, len(skin.vertices), len(fins))
    torn = replace(skin, triangles=np.concatenate([skin.triangles, fins]))
    told = doubts(found, replace(model, parts=(torn, *model.parts[1:])))
    assert any("clean surface" in line for line in told)
