"""Eyeballs that share a mesh with each other, or with all the head, turn by themselves."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from faces import toy_curves
from foreign import issues, needs_validator
from gltf_reader import Reader
from guests import PICKS, document, edited, guest
from mien.face.face import Array
from mien.formats.gltf.animated import write_animated
from mien.formats.gltf.buffer import GltfBuffer
from mien.formats.gltf.eyes import with_eye_nodes
from mien.formats.gltf.read import read_gltf
from mien.numeric.rotation import from_gaze, to_quaternion
from mien.rig.importer import Import, import_character

SHAPES = ("eyeBlinkLeft", "eyeBlinkRight", "jawOpen", "mouthSmileLeft")
EYES = ("eye_left", "eye_right")


def _write_lump(folder: Path, *, alone: bool, skinned: bool = False) -> tuple[Path, Path]:
    """A head whose eyeballs are one mesh (``alone``), or one with all the rest."""
    character = guest(SHAPES)
    face, keys = character.face, character.keys
    buffer = GltfBuffer()
    balls = {part.name: part for part in face.parts if part.follows in EYES}
    rest = [part.triangles for part in face.parts if part.follows not in EYES]
    runs = [np.concatenate([part.triangles for part in balls.values()])]
    lumps = [np.concatenate(rest), *runs] if alone else [np.concatenate([*rest, *runs])]
    places = (face.vertices / 1e3).astype(np.float32)
    attributes = {"POSITION": buffer.add(places, "vertex", bounds=True)}
    if skinned:
        joints = np.zeros((len(places), 4), np.uint16)
        joints[:, 0] = 1
        weights = np.tile(np.array([1, 0, 0, 0], np.float32), (len(places), 1))
        attributes |= {
            "JOINTS_0": buffer.add(joints, "vertex"),
            "WEIGHTS_0": buffer.add(weights, "vertex"),
        }
    targets = [
        {"POSITION": buffer.add((field / 1e3).astype(np.float32), "vertex", bounds=True)}
        for field in keys.displacements
    ]
    meshes = []
    for number, triangles in enumerate(lumps):
        indices = buffer.add(triangles.astype(np.uint32).ravel(), "element")
        primitive: dict[str, Any] = {"attributes": attributes, "indices": indices}
        if number == 0:
            primitive["targets"] = targets
        meshes.append({"name": f"lump {number}", "primitives": [primitive]})
    meshes[0]["extras"] = {"targetNames": list(SHAPES)}
    placed = {"translation": [0.1, 1.5, 0.2]}
    own = {} if skinned else placed
    nodes: list[dict[str, Any]] = [{"mesh": number} | own for number in range(len(meshes))]
    told: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [*range(len(nodes))]}],
        "nodes": nodes,
        "meshes": meshes,
    }
    if skinned:
        matrices = np.tile(np.eye(4, dtype=np.float32), (2, 1, 1))
        # Columns of a shift that puts what stands at the origin where the joint stands not.
        matrices[1, 3, :3] = [0.0, -0.1, 0.0]
        flat = np.ascontiguousarray(matrices.reshape(2, 16))
        nodes += [
            {"name": "spine", "children": [len(nodes) + 1], **placed},
            {"name": "head", "translation": [0.0, 0.1, 0.0]},
        ]
        told["scenes"][0]["nodes"].append(len(nodes) - 2)
        view = buffer.add(flat.reshape(8, 4))
        told["skins"] = [{"joints": [len(nodes) - 2, len(nodes) - 1], "inverseBindMatrices": view}]
        for node in nodes[: len(meshes)]:
            node["skin"] = 0
    folder.mkdir(parents=True, exist_ok=True)
    path, points = folder / "lump.glb", folder / "points.toml"
    path.write_bytes(buffer.glb(told))
    if skinned:
        edited(path, lambda d: d["accessors"][view].update(type="MAT4", count=2))
    shift = np.array(placed["translation"])
    lines = [f'"{p}" = {(character.face.point(p) / 1e3 + shift).tolist()}' for p in PICKS]
    points.write_text("[points]\n" + "\n".join(lines) + "\n")
    return path, points


def _imported(folder: Path, **way: bool) -> Import:
    path, points = _write_lump(folder, **way)
    return import_character(path, points=points)


def _world(told: Any, node: int) -> Array:
    above = next((i for i, n in enumerate(told["nodes"]) if node in n.get("children", [])), None)
    own = np.eye(4)
    described = told["nodes"][node]
    if "matrix" in described:
        own = np.array(described["matrix"]).reshape(4, 4).T
    own[:3, 3] += described.get("translation", [0, 0, 0])
    return own if above is None else _world(told, above) @ own


@pytest.mark.parametrize(
    "way", [{"alone": True}, {"alone": False}, {"alone": True, "skinned": True}]
)
def test_eyeballs_of_one_mesh_get_nodes(way: dict[str, bool], tmp_path: Path) -> None:
    found = _imported(tmp_path, **way)
    origin = found.character.origin
    assert origin is not None
    (tmp_path / "kept.glb").write_bytes(origin.glb)
    told = document(tmp_path / "kept.glb")
    for eye, name in zip(origin.hooks.eyes, EYES, strict=True):
        assert eye is not None
        assert told["nodes"][eye]["name"] == name
        centre = origin.turn @ found.character.face.pivots[name] / origin.scale + origin.centre
        np.testing.assert_allclose(_world(told, eye)[:3, 3], centre, atol=1e-6)
    before, after = read_gltf(tmp_path / "lump.glb"), read_gltf(tmp_path / "kept.glb")
    corners = [m.vertices[m.triangles].mean(axis=1) for m in (before, after)]
    for side in corners:
        side[:] = side[np.lexsort(np.round(side, 5).T)]
    np.testing.assert_allclose(corners[0], corners[1], atol=1e-5)
    assert len(told["meshes"]) == 3


@needs_validator
@pytest.mark.parametrize(
    "way", [{"alone": True}, {"alone": False}, {"alone": True, "skinned": True}]
)
def test_the_validator_is_content_with_them(way: dict[str, bool], tmp_path: Path) -> None:
    character = _imported(tmp_path, **way).character
    curves = toy_curves(character, names=character.keys.names)
    write_animated(tmp_path / "a.glb", character, curves)
    assert [told for told in issues(tmp_path / "a.glb") if told["severity"] < 2] == []


def test_they_turn_by_their_own_gaze(tmp_path: Path) -> None:
    character = _imported(tmp_path, alone=False).character
    origin = character.origin
    assert origin is not None
    curves = toy_curves(character, names=character.keys.names)
    gaze = np.zeros_like(curves.gaze)
    gaze[:, 0, 0], gaze[:, 1, 1] = 0.3, 0.2
    write_animated(tmp_path / "a.glb", character, replace(curves, gaze=gaze))
    channels = Reader(tmp_path / "a.glb").channels()
    for side, name in enumerate(EYES):
        _, turns = channels[name, "rotation"]
        wanted = to_quaternion(from_gaze(gaze[:1, side]))[0]
        assert np.abs(turns[0] @ wanted) == pytest.approx(1.0, abs=1e-6)


def test_eyes_that_shapes_move_stay_where_they_are(tmp_path: Path) -> None:
    """Whoever sculpted a gaze turns the eyes by it, and not twice."""
    model = read_gltf(_write_lump(tmp_path, alone=False)[0])
    moved = np.full((len(model.vertices), 3), 1e-3, np.float32)
    everything = replace(model.shapes[0], fields={0: moved})
    balls = [np.zeros(len(moved), bool) for _ in EYES]
    balls[0][:10] = balls[1][10:20] = True
    same = replace(model, shapes=(everything,))
    assert with_eye_nodes(same, balls, [np.zeros(3)] * 2) is same
