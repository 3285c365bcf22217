"""OBJ sequences, read back line by line."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from faces import toy_curves
from mien.face.animate import Poser
from mien.face.character import Character
from mien.face.pieces import split
from mien.formats.meshes.obj import write_obj_sequence


def numbers(text: str, key: str) -> np.ndarray:
    lines = [line.split()[1:] for line in text.splitlines() if line.startswith(f"{key} ")]
    return np.array(lines, dtype=float)


def test_every_frame_is_a_file_with_the_posed_face(toy_face: Character, tmp_path: Path) -> None:
    curves, poser = toy_curves(toy_face, 3), Poser(toy_face.face, split(toy_face))
    write_obj_sequence(tmp_path / "take", toy_face, curves)
    names = sorted(path.name for path in (tmp_path / "take").iterdir())
    assert names == ["frame_00001.obj", "frame_00002.obj", "frame_00003.obj", "materials.mtl"]
    for frame in range(3):
        text = (tmp_path / "take" / names[frame]).read_text()
        vertices = numbers(text, "v")
        np.testing.assert_allclose(1e3 * vertices[:, :3], poser.at(curves, frame), atol=1e-3)
        assert vertices[:, 3:].min() >= 0
        assert vertices[:, 3:].max() <= 1
        assert np.array_equal(numbers(text, "f").astype(int) - 1, toy_face.face.triangles)
        assert "mtllib materials.mtl" in text


def test_all_materials_that_are_used_are_there(toy_face: Character, tmp_path: Path) -> None:
    write_obj_sequence(tmp_path / "take", toy_face, toy_curves(toy_face, 1))
    used = (tmp_path / "take" / "frame_00001.obj").read_text().splitlines()
    told = (tmp_path / "take" / "materials.mtl").read_text()
    for line in used:
        if line.startswith("usemtl"):
            assert f"newmtl {line.split()[1]}\n" in told
