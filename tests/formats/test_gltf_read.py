"""Characters out of glTF files, of which nothing is believed."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from guests import DATA, document, edited, guest, needs_characters, write_guest, write_quad
from mien.errors import FormatError, InputError, MienError
from mien.formats.gltf.read import read_gltf
from mien.rig.importer import read_model

VALID = (
    *("control_valid.glb", "valid_mirrored_node.glb", "valid_faces_minus_z.glb"),
    *("valid_tiny_far_away.glb", "valid_default_weights_not_zero.glb"),
    "obj_negative_indices_valid.obj",
)
MENDED = (
    *("fewer_names_than_targets.glb", "duplicate_target_names.glb", "target_names_not_strings.glb"),
    *("hostile_target_names.glb", "weights_wrong_length.glb", "vrm_binds_point_nowhere.vrm"),
)


def test_what_we_write_is_read_back(tmp_path: Path) -> None:
    path, _ = write_guest(tmp_path)
    model, character = read_gltf(path), guest()
    assert model.unit == 1000.0
    assert {shape.name for shape in model.shapes} == set(character.keys.names)
    moved = {name: character.keys[name] for name in character.keys.names}
    for shape in model.shapes:
        rows = np.linalg.norm(model.dense(shape), axis=1) > 0
        wanted = np.linalg.norm(moved[shape.name], axis=1).max() / 1000.0
        assert np.linalg.norm(model.dense(shape)[rows], axis=1).max() == pytest.approx(wanted, 1e-3)
    places = character.face.vertices / 1000.0
    assert np.allclose(model.vertices.min(axis=0), places.min(axis=0), atol=1e-4)
    assert np.allclose(model.vertices.max(axis=0), places.max(axis=0), atol=1e-4)
    assert model.hooks.head is not None
    assert None not in model.hooks.eyes
    assert model.source == path.read_bytes()


def test_nodes_place_mirror_and_turn(tmp_path: Path) -> None:
    path = write_quad(tmp_path / "a.glb")
    plain = read_gltf(path)

    def change(told: Any) -> None:
        told["nodes"] = [
            {"children": [1], "translation": [5, 0, 0], "scale": [-2, 2, 2]},
            {"mesh": 0, "rotation": [0, 0, np.sqrt(0.5), np.sqrt(0.5)]},
        ]

    turned = read_gltf(edited(path, change))
    x, y, z = plain.vertices.T
    assert np.allclose(turned.vertices, np.stack([5 + 2 * y, 2 * x, 2 * z], axis=1), atol=1e-6)
    field = turned.dense(turned.shapes[0])
    assert np.allclose(field[0], [0, 0, 2])
    for model, sign in ((plain, 1.0), (turned, -1.0)):
        a, b, c = model.vertices[model.triangles[0]]
        # A mirror turns the winding round, and the reader turns it back.
        assert np.sign(np.cross(b - a, c - a)[2]) == 1.0, sign


def test_neutral_is_every_weight_at_zero(tmp_path: Path) -> None:
    path = write_quad(tmp_path / "a.glb")
    plain = read_gltf(path)
    rested = read_gltf(edited(path, lambda told: told["meshes"][0].update(weights=[0.5, 1.0])))
    assert np.array_equal(rested.vertices, plain.vertices)
    assert any("rests at other weights" in note for note in rested.notes)


def test_one_name_in_two_meshes_is_one_shape(tmp_path: Path) -> None:
    path = write_quad(tmp_path / "a.glb")

    def change(told: Any) -> None:
        first = told["meshes"][0]
        second = {**first, "extras": {"targetNames": ["wink", "smile"]}}
        first["primitives"][0]["extras"] = {"targetNames": ["smile", "wink"]}
        told["meshes"].append(second)
        told["nodes"].append({"mesh": 1, "translation": [3, 0, 0]})
        told["scenes"][0]["nodes"] = [0, 1]

    model = read_gltf(edited(path, change))
    smile, wink = model.shapes
    assert (smile.name, wink.name) == ("smile", "wink")
    assert [(bind.mesh, bind.target) for bind in smile.binds] == [(0, 0), (1, 1)]
    assert np.flatnonzero(model.dense(smile).any(axis=1)).tolist() == [0, 5]


def test_quantised_positions_are_undone(tmp_path: Path) -> None:
    path = write_quad(tmp_path / "a.glb", targets=1)
    content = json.loads(json.dumps(document(path)))
    places = np.array([[0, 0, 0, 0], [100, 0, 0, 0], [100, 100, 0, 0], [0, 100, 0, 0]], np.uint16)
    moved = np.array([[0, 0, -50, 0]] + [[0, 0, 0, 0]] * 3, np.int16)
    triangles = np.array([0, 1, 2, 0, 2, 3], np.uint16)
    binary = places.tobytes() + moved.tobytes() + triangles.tobytes()
    uri = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
    content |= {
        "extensionsRequired": ["KHR_mesh_quantization"],
        "buffers": [{"byteLength": len(binary), "uri": uri}],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 32, "byteStride": 8},
            {"buffer": 0, "byteOffset": 32, "byteLength": 32, "byteStride": 8},
            {"buffer": 0, "byteOffset": 64, "byteLength": 12},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5123, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5122, "count": 4, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "nodes": [{"mesh": 0, "scale": [0.01, 0.01, 0.01]}],
    }
    primitive = {"attributes": {"POSITION": 0}, "indices": 2, "targets": [{"POSITION": 1}]}
    content["meshes"] = [{"primitives": [primitive]}]
    (tmp_path / "a.gltf").write_text(json.dumps(content))
    model = read_gltf(tmp_path / "a.gltf")
    assert np.allclose(model.vertices.max(axis=0), [1, 1, 0])
    assert np.allclose(model.dense(model.shapes[0])[0], [0, 0, -0.5])
    # What lies beside the document comes along, in one file.
    (tmp_path / "b.glb").write_bytes(model.source or b"")
    assert np.allclose(read_gltf(tmp_path / "b.glb").vertices, model.vertices)


_MESHOPT = {"EXT_meshopt_compression": {}}


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda d: d["accessors"][0].update(count=10**9), "count"),
        (lambda d: d["accessors"][0].update(count=40), "past the end"),
        (lambda d: d["accessors"][1].update(componentType=5125), "past the end"),
        (lambda d: d["nodes"][0].update(children=[0]), "hangs in two places"),
        (lambda d: d["nodes"][0].update(scale=[1, 2]), "scale"),
        (lambda d: d.update(extensionsRequired=["ACME_cubes"]), "ACME_cubes"),
        (lambda d: d["meshes"][0]["primitives"][0].update(mode=1), "no triangles"),
        (lambda d: d.update(buffers=[{"byteLength": 9, "uri": "../x.bin"}]), "outside"),
        (
            lambda d: d.update(buffers=[{"byteLength": 9, "uri": "https://x.y/z"}]),
            "fetches nothing",
        ),
    ],
)
def test_broken_files_are_refused_in_a_line(tmp_path: Path, change: Any, told: str) -> None:
    path = edited(write_quad(tmp_path / "a.glb"), change)
    with pytest.raises(FormatError, match=told) as caught:
        read_gltf(path)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)


def test_more_than_memory_holds_is_refused_before_it_is_read(tmp_path: Path) -> None:
    def bomb(told: Any) -> None:
        told["accessors"] = [{"componentType": 5126, "count": 2_000_000, "type": "VEC3"}]
        primitive = {"attributes": {"POSITION": 0}, "targets": [{"POSITION": 0}] * 10_000}
        told["meshes"] = [{"primitives": [primitive]}]

    with pytest.raises(FormatError, match="memory"):
        read_gltf(edited(write_quad(tmp_path / "a.glb"), bomb))


def test_a_missing_file_is_said_to_be_missing(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no such file"):
        read_gltf(tmp_path / "nobody.glb")


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_damage_is_never_more_than_an_error(tmp_path_factory: Any, data: st.DataObject) -> None:
    path = write_quad(tmp_path_factory.getbasetemp() / "fuzz.glb", targets=3)
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 6))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content[: data.draw(st.integers(0, len(content)))])
    try:
        model = read_gltf(path)
    except MienError:
        return
    assert np.isfinite(model.vertices).all()
    assert model.triangles.max() < len(model.vertices)


@needs_characters
@pytest.mark.parametrize("name", VALID)
def test_valid_files_load_with_their_geometry(name: str) -> None:
    control = read_model(DATA / "bad" / "control_valid.glb")
    model = read_model(DATA / "bad" / name)
    assert (len(model.vertices), len(model.triangles)) == (507, 968)
    spread = np.ptp(model.vertices, axis=0)
    assert np.allclose(
        spread / spread.max(), np.ptp(control.vertices, axis=0) / 2.734375, atol=1e-4
    )
    if name == "valid_mirrored_node.glb":
        assert np.allclose(model.vertices, control.vertices * [-1, 1, 1], atol=1e-5)


@needs_characters
@pytest.mark.parametrize("name", MENDED)
def test_mended_files_say_what_was_mended(name: str) -> None:
    assert read_model(DATA / "bad" / name).notes


@needs_characters
def test_all_other_bad_files_are_refused() -> None:
    rest = [
        path
        for path in sorted((DATA / "bad").iterdir())
        if path.name not in (*VALID, *MENDED, "README.md")
    ]
    assert len(rest) == 52
    for path in rest:
        with pytest.raises(MienError) as caught:
            read_model(path)
        assert path.name in str(caught.value)
