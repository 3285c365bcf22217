"""Characters from folders of OBJ files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mien.errors import InputError, MienError
from mien.formats.meshes.character_folder import read_folder, read_obj_model
from mien.formats.meshes.obj_read import read_obj

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n"
FACES = "f 1/1/1 2/2/1 3 4\nf -5 -2 -1 -4\n"


def _folder(folder: Path, **files: str) -> Path:
    for name, text in files.items():
        (folder / f"{name}.obj").write_text(text)
    return folder


def test_shapes_are_differences_from_the_neutral(tmp_path: Path) -> None:
    lifted = SQUARE.replace("v 1 1 0", "v 1 1 0.5") + FACES
    flat = SQUARE.replace("v 0 0 0", "v 0 0 -1")
    folder = _folder(tmp_path, base=SQUARE + FACES, morph10=flat, morph2=lifted, identity007=flat)
    model = read_folder(folder)
    assert [shape.name for shape in model.shapes] == ["morph2", "morph10"]
    assert np.allclose(model.dense(model.shapes[0])[2], [0, 0, 0.5])
    assert np.allclose(model.dense(model.shapes[1])[0], [0, 0, -1])
    assert model.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [1, 4, 5], [1, 5, 2]]
    assert any("identities" in note for note in model.notes)
    assert model.unit is None


def test_ict_facekits_names_are_understood(tmp_path: Path) -> None:
    folder = _folder(tmp_path, generic_neutral_mesh=SQUARE + FACES, browDown_L=SQUARE + FACES)
    model = read_folder(folder)
    assert [shape.name for shape in model.shapes] == ["browDown_L"]
    assert model.shapes[0].fields == {}


@pytest.mark.parametrize(
    ("files", "told"),
    [
        ({}, "no OBJ files"),
        ({"a": SQUARE + FACES}, "0 files could be the neutral"),
        ({"base": SQUARE + FACES, "neutral": SQUARE + FACES}, "2 files could be"),
        ({"base": SQUARE}, "no faces"),
        ({"base": SQUARE + "f 1 2 3 9\n"}, "not among|not there"),
        ({"base": SQUARE + "f 1 2\n"}, "a face of 2 corners"),
        ({"base": SQUARE + "f 0 1 2\n"}, "not there"),
        ({"base": SQUARE + "f 1 x 2\n"}, "not numbers"),
        ({"base": SQUARE + FACES + "v 1 nan 0\n"}, "beyond all bounds"),
        ({"base": SQUARE + FACES + "v 1 two 0\n"}, "not three numbers"),
        ({"base": "v 1 1 1\n" * 6 + FACES}, "in one place"),
        ({"base": "v 0 0 0\n" * 5 + "v 1 1 1\n" + "f 1 2 3\n"}, "not one face has an area"),
        ({"base": SQUARE + FACES, "a": SQUARE + "v 9 9 9\n"}, "7 vertices, but the neutral has 6"),
        ({"base": SQUARE + FACES, "a": SQUARE + "f 1 2 3 4\n"}, "another order"),
    ],
)
def test_what_does_not_fit_is_named(tmp_path: Path, files: dict[str, str], told: str) -> None:
    with pytest.raises(InputError, match=told) as caught:
        read_folder(_folder(tmp_path, **files))
    assert str(tmp_path) in str(caught.value)


def test_one_file_is_a_face_without_shapes(tmp_path: Path) -> None:
    model = read_obj_model(_folder(tmp_path, head=SQUARE + FACES) / "head.obj")
    assert (len(model.vertices), len(model.shapes), model.name) == (6, 0, "head")


@settings(max_examples=100, deadline=None)
@given(st.data())
def test_damage_is_never_more_than_an_error(tmp_path_factory: Any, data: st.DataObject) -> None:
    path = tmp_path_factory.getbasetemp() / "fuzz.obj"
    content = bytearray((SQUARE + FACES).encode())
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content)
    try:
        mesh = read_obj(path)
    except MienError:
        return
    assert np.isfinite(mesh.vertices).all()
    assert not len(mesh.triangles) or mesh.triangles.min() >= 0
    assert not len(mesh.triangles) or mesh.triangles.max() < len(mesh.vertices)
