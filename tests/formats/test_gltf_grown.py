"""Morph targets added to somebody's file, which stays what it was."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from faces import toy_character
from foreign import issues, needs_validator
from mien.face.model import Model
from mien.formats.gltf.glb import write_glb
from mien.formats.gltf.grown import write_grown
from mien.formats.gltf.pack import glb, opened
from mien.formats.gltf.read import read_gltf

NAMES = ("one", "two")


def _neutral(folder: Path) -> Model:
    """A textured toy under a node that turns, moves and scales it, with a take of its shapes."""
    write_glb(folder / "toy.glb", toy_character())
    document, binary = opened((folder / "toy.glb").read_bytes())
    nodes, scene = document["nodes"], document["scenes"][0]
    nodes.append(
        {
            "children": scene["nodes"],
            "rotation": [0.0, 0.6, 0.0, 0.8],
            "translation": [1.0, 2.0, 3.0],
            "scale": [2.0, 1.0, 0.5],
        }
    )
    scene["nodes"] = [len(nodes) - 1]
    (folder / "toy.glb").write_bytes(glb(document, bytes(binary)))
    return read_gltf(folder / "toy.glb")


def _fields(model: Model) -> np.ndarray:
    """The first part moves, and nothing else."""
    fields = np.zeros((2, len(model.vertices), 3), dtype=np.float32)
    first = len(model.parts[0].vertices)
    rng = np.random.default_rng(1)
    fields[0, : first // 2] = rng.normal(0.0, 0.01, (first // 2, 3))
    fields[1, :first] = (0.01, 0.0, -0.02)
    return fields


def test_what_is_added_is_read_again_and_the_rest_is_as_it_was(tmp_path: Path) -> None:
    model = _neutral(tmp_path)
    fields = _fields(model)
    write_grown(tmp_path / "more.glb", model, NAMES, fields)
    found = read_gltf(tmp_path / "more.glb")
    shapes = {shape.name: found.dense(shape) for shape in found.shapes}
    assert set(shapes) == {*(shape.name for shape in model.shapes), *NAMES}
    for name, field in zip(NAMES, fields, strict=True):
        assert np.abs(shapes[name] - field).max() < 1e-6
    for shape in model.shapes:
        assert np.array_equal(shapes[shape.name], model.dense(shape))
    assert np.array_equal(found.vertices, model.vertices)
    old, _ = opened((tmp_path / "toy.glb").read_bytes())
    new, _ = opened((tmp_path / "more.glb").read_bytes())
    for kind in ("materials", "textures", "images", "samplers", "nodes"):
        assert json.dumps(new.get(kind)) == json.dumps(old.get(kind))


def test_a_face_without_a_file_cannot_grow(tmp_path: Path) -> None:
    model = Model("bare", (), ())
    with pytest.raises(ValueError, match="bare"):
        write_grown(tmp_path / "more.glb", model, NAMES, np.zeros((2, 0, 3), np.float32))


@needs_validator
def test_the_validator_finds_nothing_to_say_of_it(tmp_path: Path) -> None:
    model = _neutral(tmp_path)
    write_grown(tmp_path / "more.glb", model, NAMES, _fields(model))
    assert issues(tmp_path / "more.glb") == []
