"""PLY: every dialect reads alike, and nothing a file says is believed before it is checked."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mien.errors import FormatError
from mien.formats.meshes.ply import read_ply

VERTICES = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.5]], dtype=float)
COLOURS = np.array([[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]], np.uint8)
KINDS = ("ascii", "binary_little_endian", "binary_big_endian")


def ply(
    kind: str = "binary_little_endian",
    polygons: tuple[tuple[int, ...], ...] = ((0, 1, 2), (0, 2, 3)),
    vertices: np.ndarray = VERTICES,
    counts: tuple[int, int] | None = None,
    comment: str = "comment units cm",
) -> bytes:
    """A little coloured mesh with an element nobody knows before its faces."""
    many = counts or (len(vertices), len(polygons))
    head = (
        f"ply\nformat {kind} 1.0\n{comment}\nelement vertex {many[0]}\nproperty float x\n"
        "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
        "property uchar blue\nelement camera 1\nproperty list uchar short tags\nproperty int id\n"
        f"element face {many[1]}\nproperty uchar flag\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    if kind == "ascii":
        rows = [
            " ".join(map(str, (*v, *c))) for v, c in zip(vertices.tolist(), COLOURS, strict=True)
        ]
        faces = [" ".join(map(str, (7, len(p), *p))) for p in polygons]
        return (head + "\n".join([*rows, "2 5 6 9", *faces]) + "\n").encode()
    order = "<" if "little" in kind else ">"
    body = b""
    for v, c in zip(vertices, COLOURS, strict=True):
        body += v.astype(f"{order}f4").tobytes() + c.tobytes()
    body += b"\2" + np.array([5, 6], f"{order}i2").tobytes() + np.array(9, f"{order}i4").tobytes()
    for p in polygons:
        body += bytes([7, len(p)]) + np.array(p, f"{order}i4").tobytes()
    return head.encode() + body


def read(tmp_path: Path, data: bytes) -> object:
    path = tmp_path / "scan.ply"
    path.write_bytes(data)
    return read_ply(path)


@pytest.mark.parametrize("kind", KINDS)
def test_every_dialect_reads_alike(tmp_path: Path, kind: str) -> None:
    mesh = read(tmp_path, ply(kind))
    assert mesh.vertices == pytest.approx(VERTICES)
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3]]
    assert mesh.colours == pytest.approx(COLOURS / 255.0)
    assert mesh.unit == "cm"


@pytest.mark.parametrize("kind", KINDS)
def test_polygons_become_fans_in_their_order(tmp_path: Path, kind: str) -> None:
    mesh = read(tmp_path, ply(kind, ((1, 2, 3), (0, 1, 2, 3), (3, 0, 1))))
    assert mesh.triangles.tolist() == [[1, 2, 3], [0, 1, 2], [0, 2, 3], [3, 0, 1]]


def test_what_the_scanner_did_not_see_is_left_out(tmp_path: Path) -> None:
    unseen = VERTICES.copy()
    unseen[3] = np.nan
    mesh = read(tmp_path, ply(vertices=unseen, polygons=((0, 1, 2), (0, 2, 3), (1, 1, 2))))
    assert mesh.triangles.tolist() == [[0, 1, 2]]
    assert len(mesh.vertices) == len(mesh.colours) == 3


def test_an_unknown_unit_is_not_guessed(tmp_path: Path) -> None:
    assert read(tmp_path, ply(comment="comment made by hand")).unit == ""


@pytest.mark.parametrize(
    ("data", "told"),
    [
        (b"", "not a PLY"),
        (b"solid head\n", "not a PLY"),
        (ply(counts=(4, 2_000_000_000)), "promises"),
        (ply(counts=(2_000_000_000, 2)), "promises"),
        (ply("ascii", counts=(4, 2_000_000_000)), "promises"),
        (ply(counts=(4, 3)), "cut off"),
        (ply()[:-3], "cut off"),
        (ply(polygons=((0, 1, 9),)), "not among"),
        (ply("ascii", polygons=((0, 1, -2),)), "not among"),
        (ply(polygons=((0, 1),)), "2 corners"),
        (ply(polygons=()), "no faces"),
        (ply(polygons=((1, 1, 2),)), "not one triangle"),
        (ply("ascii").replace(b"1.0 1.0", b"1.0 one"), "text where numbers"),
        (ply().replace(b"1.0\n", b"1.0\nproperty float lost\n"), "means nothing"),
        (ply().replace(b"property float z", b"property float w"), "x, y and z"),
        (ply().replace(b"binary_little_endian", b"binary_middle_endian"), "unknown format"),
    ],
)
def test_a_broken_file_is_told(tmp_path: Path, data: bytes, told: str) -> None:
    with pytest.raises(FormatError, match=told) as raised:
        read(tmp_path, data)
    assert "scan.ply" in str(raised.value)
    assert "\n" not in str(raised.value)


@settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(
    kind=st.sampled_from(KINDS),
    at=st.integers(0, 2000),
    bits=st.integers(1, 255),
    cut=st.integers(0, 2000),
)
def test_damage_is_an_error_or_a_sound_mesh(
    tmp_path: Path, kind: str, at: int, bits: int, cut: int
) -> None:
    data = bytearray(ply(kind))
    data[at % len(data)] ^= bits
    try:
        mesh = read(tmp_path, bytes(data[: max(1, len(data) - cut % 40)]))
    except FormatError:
        return
    assert np.isfinite(mesh.vertices).all()
    assert 0 <= mesh.triangles.min() <= mesh.triangles.max() < len(mesh.vertices)
