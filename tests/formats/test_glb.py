"""What we write as GLB, read back by a reader that is not ours."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from faces import toy_curves
from gltf_reader import Reader
from mien.face.animate import Poser
from mien.face.character import Character
from mien.face.pieces import split
from mien.formats.gltf.glb import write_glb
from mien.numeric.normals import vertex_normals

PARTS = {
    "face": ["skin"],
    "eye_left": ["eye_left"],
    "eye_right": ["eye_right"],
    "teeth_upper": ["teeth_upper"],
    "bust": ["bust"],
}
"""Mesh nodes of the toy face and the parts in them."""


@pytest.fixture
def acting(toy_face: Character, tmp_path: Path) -> Reader:
    write_glb(tmp_path / "a.glb", toy_face, toy_curves(toy_face))
    return Reader(tmp_path / "a.glb")


def rows(character: Character, node: str) -> np.ndarray:
    parts = [character.face.part(name) for name in PARTS[node]]
    return np.concatenate([np.arange(part.first, part.last) for part in parts])


def test_every_frame_is_where_the_poser_puts_it(toy_face: Character, acting: Reader) -> None:
    curves = toy_curves(toy_face)
    poser = Poser(toy_face.face, split(toy_face))
    for frame in range(len(curves)):
        expected, found = poser.at(curves, frame), acting.world(frame)
        assert found.keys() == PARTS.keys()
        for node, places in found.items():
            # Motion under 0.04 mm a target is not stored.
            np.testing.assert_allclose(places, expected[rows(toy_face, node)], atol=0.05)


def test_weights_and_times_are_kept_exactly(toy_face: Character, acting: Reader) -> None:
    curves = toy_curves(toy_face)
    assert tuple(acting.target_names()) == curves.names
    times, weights = acting.channels()["face", "weights"]
    assert np.array_equal(times, curves.time.astype(np.float32))
    assert np.array_equal(weights.reshape(len(times), -1), curves.weights.astype(np.float32))


def test_quaternions_never_take_the_long_way_round(acting: Reader) -> None:
    for (_, path), (_, values) in acting.channels().items():
        if path == "rotation":
            assert ((values[1:] * values[:-1]).sum(axis=1) > 0).all()
            np.testing.assert_allclose(np.linalg.norm(values, axis=1), 1.0, atol=1e-6)


def test_a_still_character_offers_its_key_models(toy_face: Character, tmp_path: Path) -> None:
    write_glb(tmp_path / "a.glb", toy_face)
    reader = Reader(tmp_path / "a.glb")
    assert tuple(reader.target_names()) == toy_face.keys.names
    assert not reader.gltf.animations
    for node, places in reader.world(None).items():
        neutral = toy_face.face.vertices[rows(toy_face, node)]
        np.testing.assert_allclose(places, neutral, atol=1e-4)


def test_a_still_character_can_be_painted(toy_face: Character, tmp_path: Path) -> None:
    uv = np.random.default_rng(3).uniform(0, 1, (len(toy_face.face.vertices), 2))
    write_glb(tmp_path / "a.glb", replace(toy_face, face=replace(toy_face.face, uv=uv)))
    reader = Reader(tmp_path / "a.glb")
    (primitive,) = reader.gltf.meshes[reader.gltf.nodes[reader.node("face")].mesh].primitives
    found = reader.accessor(primitive.attributes.TEXCOORD_0) / 65535.0
    np.testing.assert_allclose(found, uv[rows(toy_face, "face")], atol=1e-5)
    material = reader.gltf.materials[primitive.material].pbrMetallicRoughness
    assert reader.gltf.textures[material.baseColorTexture.index].source == 0


def test_morph_normals_are_those_of_the_morphed_surface(
    toy_face: Character, tmp_path: Path
) -> None:
    write_glb(tmp_path / "a.glb", toy_face)
    reader = Reader(tmp_path / "a.glb")
    mesh = reader.gltf.meshes[reader.gltf.nodes[reader.node("face")].mesh]
    (primitive,) = mesh.primitives
    target = primitive.targets[reader.target_names().index("jaw_open")]
    change = reader.accessor(target["NORMAL"])
    found = reader.accessor(primitive.attributes.NORMAL) + change
    surface = toy_face.face.vertices + toy_face.keys["jaw_open"]
    skin = toy_face.face.part("skin")
    expected = vertex_normals(surface, skin.triangles)[skin.first : skin.last]
    np.testing.assert_allclose(found, expected, atol=0.04)
    assert np.abs(change).max() > 0.1


def test_what_does_not_move_carries_no_targets(acting: Reader) -> None:
    for name in PARTS.keys() - {"face"}:
        mesh = acting.gltf.meshes[acting.gltf.nodes[acting.node(name)].mesh]
        assert not any(primitive.targets for primitive in mesh.primitives)


def test_a_head_that_stays_has_no_channel_for_travel(toy_face: Character, tmp_path: Path) -> None:
    curves = toy_curves(toy_face)
    still = replace(curves, translation=np.zeros_like(curves.translation))
    write_glb(tmp_path / "a.glb", toy_face, still)
    paths = set(Reader(tmp_path / "a.glb").channels())
    assert not any(path == "translation" for _, path in paths)
    assert ("head", "rotation") in paths


def test_foreign_curves_are_refused(toy_face: Character, tmp_path: Path) -> None:
    curves = toy_curves(toy_face, names=("smile_L", "wings_flap"))
    with pytest.raises(ValueError, match="wings_flap"):
        write_glb(tmp_path / "a.glb", toy_face, curves)
    assert not list(tmp_path.iterdir())
