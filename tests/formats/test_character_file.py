"""Character files: what is written is read, and what is broken is said to be."""

from __future__ import annotations

import io
import json
import zipfile
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from mien.errors import FormatError, InputError, MienError, OutputError
from mien.face.character import Character, KeyModels
from mien.face.face import Face, FeaturePoints, Material, Part
from mien.face.store import read_character, write_character

_ONE_FOLDER = [HealthCheck.function_scoped_fixture]


def _small() -> Character:
    """Two parts, two key models."""
    random = np.random.default_rng(1)
    triangles = np.array([[0, 1, 2], [2, 1, 3]], dtype=np.int32)
    face = Face(
        vertices=random.normal(0, 30, (8, 3)),
        parts=(
            Part("skin", "skin", 0, 4, triangles),
            Part("hat", "felt", 4, 8, triangles + np.int32(4), "body"),
        ),
        materials={"skin": Material(subsurface=1.0), "felt": Material(casts_shadow=False)},
        colours=random.uniform(0, 1, (8, 3)),
        occlusion=random.uniform(0, 1, 8),
        points=FeaturePoints(
            ("2.1", "7.1"),
            np.array([[0, 1, 2], [4, 5, 6]], np.int32),
            np.array([[1.0, 0, 0], [0.5, -0.25, 0.75]]),
        ),
        pivots={name: random.normal(0, 9, 3) for name in ("head", "jaw", "eye_left", "eye_right")},
        uv=random.uniform(0, 1, (8, 2)),
    )
    moved = random.normal(0, 5, (2, 8, 3)).astype(np.float32)
    moved[0, 4:] = 0
    return Character("small", face, KeyModels(("smile", "frown"), moved), ("smile",))


def test_what_is_written_is_read(tmp_path: Path) -> None:
    written = _small()
    write_character(tmp_path / "small.npz", written)
    read = read_character(tmp_path / "small.npz")
    assert (read.name, read.examples, read.keys.names) == ("small", ("smile",), ("smile", "frown"))
    assert np.abs(read.face.vertices - written.face.vertices).max() < 1e-4
    assert np.abs(read.keys.displacements - written.keys.displacements).max() <= 0.00051
    assert not read.keys["smile"][4:].any()
    assert [(p.name, p.follows) for p in read.face.parts] == [("skin", "head"), ("hat", "body")]
    assert (read.face.triangles == written.face.triangles).all()
    assert read.face.materials == written.face.materials
    assert np.abs(read.face.colours - written.face.colours).max() < 0.01
    assert np.abs(read.face.occlusion - written.face.occlusion).max() < 0.01
    assert np.abs(read.face.uv - written.face.uv).max() < 1e-5
    assert np.allclose(read.face.point("7.1"), written.face.point("7.1"), atol=1e-4)
    assert np.allclose(read.face.pivots["jaw"], written.face.pivots["jaw"])
    # Read and written again it is the same file, to the last byte.
    write_character(tmp_path / "again.npz", read)
    write_character(tmp_path / "third.npz", read_character(tmp_path / "again.npz"))
    assert (tmp_path / "again.npz").read_bytes() == (tmp_path / "third.npz").read_bytes()


def test_no_half_file_is_left(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="nowhere"):
        write_character(tmp_path / "nowhere" / "small.npz", _small())
    assert not list(tmp_path.iterdir())


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"gone\.npz: no such file"):
        read_character(tmp_path / "gone.npz")


def test_a_foreign_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "text.npz").write_text("a face")
    np.savez(tmp_path / "other.npz", vertices=np.zeros((3, 3)))
    for name in ("text.npz", "other.npz"):
        with pytest.raises(FormatError, match="not a mien character"):
            read_character(tmp_path / name)


@given(data=st.data())
@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
def test_broken_bytes_never_do_more_than_say_so(data: st.DataObject, tmp_path: Path) -> None:
    path = tmp_path / "small.npz"
    write_character(path, _small())
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 6))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    path.write_bytes(content[: data.draw(st.integers(0, len(content)))])
    with suppress(MienError):
        assert read_character(path).face.vertices.shape == (8, 3)


@given(data=st.data())
@settings(
    max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
def test_a_wrong_description_is_refused(data: st.DataObject, tmp_path: Path) -> None:
    """Anything but the truth under any name of the description: refused, or harmless."""
    path = tmp_path / "small.npz"
    write_character(path, _small())
    about = _about(path)
    spot: object = about
    while isinstance(spot, dict | list) and spot:
        holder = spot
        keys = sorted(spot) if isinstance(spot, dict) else range(len(spot))
        key = data.draw(st.sampled_from(list(keys)))
        spot = holder[key]
        if data.draw(st.booleans()):
            break
    holder[key] = data.draw(
        st.one_of(st.none(), st.integers(-5, 10**12), st.floats(), st.text(max_size=4), st.just([]))
    )
    _replace(path, "about", np.frombuffer(json.dumps(about).encode(), np.uint8))
    try:
        read = read_character(path)
    except FormatError:
        return
    assert read.surface(np.ones(len(read.keys.names))).shape == read.face.vertices.shape
    assert read.face.triangles.max() < len(read.face.vertices)


def test_a_header_that_promises_too_much_is_not_believed(tmp_path: Path) -> None:
    path = tmp_path / "small.npz"
    write_character(path, _small())
    held = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        held, {"descr": "<f4", "fortran_order": False, "shape": (10**12, 3)}
    )
    _replace_bytes(path, "vertices", held.getvalue())
    with pytest.raises(FormatError, match="vertices is cut short"):
        read_character(path)


def _about(path: Path) -> dict[str, object]:
    with np.load(path) as archive:
        about: dict[str, object] = json.loads(archive["about"].tobytes())
        return about


def _replace(path: Path, name: str, array: np.ndarray) -> None:
    held = io.BytesIO()
    np.lib.format.write_array(held, array)
    _replace_bytes(path, name, held.getvalue())


def _replace_bytes(path: Path, name: str, content: bytes) -> None:
    with zipfile.ZipFile(path) as archive:
        entries = {entry: archive.read(entry) for entry in archive.namelist()}
    entries[f"{name}.npy"] = content
    with zipfile.ZipFile(path, "w") as archive:
        for entry, kept in entries.items():
            archive.writestr(entry, kept)
