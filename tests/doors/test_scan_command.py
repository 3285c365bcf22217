"""mien scan points and mien databank build, as a user runs them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from terminal import error_line, mien, needs_landmarks

from mien.face.library import load_character
from mien.formats.databank_file import read_databank
from mien.formats.notes.scan_points import PointsFile, read_points, write_points
from mien.scan.template import face_template

pytest.importorskip("embreex")


def write_scan(path: Path, key: str | None = None, unit: str = "mm", scale: float = 1.0) -> Path:
    """The woman as a scan with colours, and her points beside it."""
    woman = load_character("woman")
    face = woman.face
    places = scale * (face.vertices + (0.0 if key is None else woman.keys[key]))
    head = [part for part in face.parts if part.follows != "body"]
    triangles = np.concatenate([part.triangles for part in head])
    comment = f"comment units {unit}\n" if unit else ""
    header = (
        f"ply\nformat binary_little_endian 1.0\n{comment}element vertex {len(places)}\n"
        "property float x\nproperty float y\nproperty float z\nproperty uchar red\n"
        "property uchar green\nproperty uchar blue\n"
        f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    rows = np.empty(len(places), [("p", "<f4", 3), ("c", "u1", 3)])
    rows["p"], rows["c"] = places, 255 * np.clip(face.colours, 0, 1) ** (1 / 2.2)
    corners = np.empty(len(triangles), [("n", "u1"), ("i", "<i4", 3)])
    corners["n"], corners["i"] = 3, triangles
    path.write_bytes(header.encode() + rows.tobytes() + corners.tobytes())
    return path


def write_true_points(scan: Path, key: str | None = None) -> None:
    woman = load_character("woman")
    places = woman.face.vertices + (0.0 if key is None else woman.keys[key])
    ids = face_template(woman.face, 0).points.ids
    known = woman.face.points.at(places)[woman.face.points.index(ids)]
    write_points(scan.with_suffix(".points.toml"), PointsFile(scan.name, False, ids, known))


@needs_landmarks
def test_points_are_found_and_can_be_corrected(tmp_path: Path) -> None:
    scan = write_scan(tmp_path / "head.ply", unit="m", scale=1e-3)
    done = mien("scan", "points", scan, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "head.points.png").stat().st_size > 10_000
    found = read_points(tmp_path / "head.points.toml")
    assert found.scan == "head.ply"
    assert found.found
    assert len(found.ids) > 40
    woman = load_character("woman").face
    true = woman.points.at(woman.vertices)[woman.points.index(found.ids)]
    assert np.median(np.linalg.norm(1e3 * found.places - true, axis=1)) < 3.0


@needs_landmarks
def test_what_a_scan_does_not_say_is_asked_for(tmp_path: Path) -> None:
    scan = write_scan(tmp_path / "head.ply", unit="", scale=1e-3)
    assert "--units m" in error_line(mien("scan", "points", scan, cwd=tmp_path))
    wrong = error_line(mien("scan", "points", scan, "--units", "cm", cwd=tmp_path))
    assert "pupils" in wrong
    assert wrong.endswith("--units m")
    fallen = mien("scan", "points", scan, "--units", "m", "--up=-y", cwd=tmp_path)
    assert "--up" in error_line(fallen)
    assert [path.name for path in tmp_path.iterdir()] == ["head.ply"]


def test_a_databank_is_built_from_scans_with_points(tmp_path: Path) -> None:
    for name, key in (("neutral", None), ("smile", "smile")):
        write_true_points(write_scan(tmp_path / f"{name}.ply", key), key)
    done = mien("databank", "build", "neutral.ply", "smile.ply", "-o", "bank", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    bank = read_databank(tmp_path / "bank.npz")
    assert bank.names == ("smile",)
    corner = bank.face.points.index(["8.3"])[0]
    assert bank.face.points.at(bank.displacements[0])[corner, 1] > 2.0


def test_a_databank_that_cannot_be_is_told(tmp_path: Path) -> None:
    def said(*arguments: str) -> str:
        return error_line(mien("databank", "build", *arguments, cwd=tmp_path))

    assert "either scans or --from-folder" in said()
    assert "--neutral" in said("smile.ply", "sad.ply")
    assert "absent" in said("neutral.ply", "smile.ply").replace("no such file", "absent")
    write_true_points(write_scan(tmp_path / "neutral.ply"))
    (tmp_path / "smile.ply").write_bytes((tmp_path / "neutral.ply").read_bytes()[:5000])
    write_true_points(tmp_path / "smile.ply")
    assert "smile.ply" in said("neutral.ply", "smile.ply", "-o", "bank")
    assert not (tmp_path / "bank.npz").exists()
