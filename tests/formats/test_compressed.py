"""Files that meshopt or Draco compressed are read, and written as everybody can open them."""

from __future__ import annotations

import builtins
import contextlib
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from meshopt_walk import digest, read, streams
from scipy.spatial import cKDTree

from foreign import blender, issues, needs_blender, needs_validator
from guests import DATA, document, edited, needs_characters
from mien.errors import FormatError, MienError, MissingExtraError
from mien.face.model import Model
from mien.formats.gltf.meshopt import decode
from mien.formats.gltf.read import read_gltf

HERE = Path(__file__).parents[1] / "compressed"
COMPRESSED = ("meshopt.glb", "meshopt_khr.glb", "draco.glb")
_STEP = 1e-4
"""What quantising a sheet of size one costs."""


@pytest.mark.parametrize("told", streams(), ids=lambda t: f"{t['mode']}-{t['filter']}")
def test_streams_of_the_reference_encoder(told: dict[str, Any]) -> None:
    found = read(told)
    assert len(found) == len(told["elements"])
    if told["filter"] == "NONE":
        assert found == told["elements"]
    else:
        width = "<f4" if told["filter"] == "EXPONENTIAL" else f"<i{max(told['stride'] // 4, 1)}"
        ours, theirs = (np.frombuffer(b, width).astype(float) for b in (found, told["elements"]))
        # One unit in the last place is the specification's own leave; colours wrap as unsigned.
        off = np.abs(ours - theirs)
        assert np.minimum(off, np.abs(off - 2.0 ** (8 * np.dtype(width).itemsize))).max() <= 1


def test_kernels_read_past_no_end() -> None:
    """The same loops in plain Python, where an index too large is an error, find the same."""
    path = os.pathsep.join([str(Path(__file__).parent), *sys.path])
    run = subprocess.run(
        [sys.executable, Path(__file__).parent / "meshopt_walk.py"],
        env=os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=False,
    )
    assert run.stdout.strip() == digest(2), run.stderr


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_damaged_streams_are_refused_or_fill_their_layout(data: st.DataObject) -> None:
    told = data.draw(st.sampled_from(streams()))
    stream = bytearray(told["stream"])
    for place in data.draw(st.lists(st.integers(0, len(stream) - 1), min_size=1, max_size=6)):
        stream[place] = data.draw(st.integers(0, 255))
    cut = bytes(stream[: data.draw(st.integers(0, len(stream)))])
    for some in (bytes(stream), cut):
        try:
            found = decode(some, told["count"], told["stride"], told["mode"], told["filter"])
        except ValueError:
            continue
        assert len(found) == told["count"] * told["stride"]


@pytest.mark.parametrize("layout", [(3, 4, "NONSENSE", "NONE"), (3, 5, "ATTRIBUTES", "NONE")])
def test_layouts_that_are_none(layout: tuple[int, int, str, str]) -> None:
    with pytest.raises(ValueError, match="layout"):
        decode(b"\xa0" + bytes(64), *layout)


def _matched(model: Model, plain: Model) -> tuple[float, float]:
    """Largest distance of vertices and of displacements from those of the plain file."""
    away, row = cKDTree(plain.vertices).query(model.vertices)
    assert set(row) == set(range(len(plain.vertices)))
    fields = {shape.name: plain.dense(shape) for shape in plain.shapes}
    assert fields.keys() == {shape.name for shape in model.shapes}
    off = [np.abs(model.dense(s) - fields[s.name][row]).max() for s in model.shapes]
    return float(away.max()), float(max(off))


@pytest.mark.parametrize("name", COMPRESSED)
def test_shapes_come_out_as_they_went_in(name: str) -> None:
    if name == "draco.glb":
        pytest.importorskip("DracoPy")
    place, field = _matched(read_gltf(HERE / name), read_gltf(HERE / "plain.glb"))
    assert max(place, field) < _STEP


@pytest.mark.parametrize("name", COMPRESSED)
def test_what_is_kept_of_it_is_plain(name: str, tmp_path: Path) -> None:
    if name == "draco.glb":
        pytest.importorskip("DracoPy")
    model = read_gltf(HERE / name)
    path = tmp_path / name
    path.write_bytes(model.source or b"")
    told = document(path)
    assert len(told["buffers"]) == 1
    assert {*told.get("extensionsUsed", [])} <= {"KHR_mesh_quantization"}
    assert not any("extensions" in view for view in told["bufferViews"])
    again = read_gltf(path)
    assert np.array_equal(again.vertices, model.vertices)
    assert again.source == path.read_bytes()


@needs_validator
@pytest.mark.parametrize("name", COMPRESSED)
def test_the_validator_is_content(name: str, tmp_path: Path) -> None:
    if name == "draco.glb":
        pytest.importorskip("DracoPy")
    (tmp_path / name).write_bytes(read_gltf(HERE / name).source or b"")
    # Texture coordinates that nothing uses were there before.
    found = [told["code"] for told in issues(tmp_path / name)]
    assert {*found} <= {"UNUSED_OBJECT"}


@needs_blender
@pytest.mark.parametrize("name", COMPRESSED)
def test_blender_opens_it(name: str, tmp_path: Path) -> None:
    if name == "draco.glb":
        pytest.importorskip("DracoPy")
    (tmp_path / name).write_bytes(read_gltf(HERE / name).source or b"")
    found = blender(tmp_path / name)
    assert any(
        seen.get("shape_keys", [])[1:] == ["left", "middle", "right"] for seen in found.values()
    )


def test_without_dracopy_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    real = builtins.__import__

    def without(name: str, *rest: Any, **more: Any) -> Any:
        if name == "DracoPy":
            raise ImportError(name)
        return real(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", without)
    with pytest.raises(MissingExtraError, match=r"draco\.glb.*mien\[draco\]"):
        read_gltf(HERE / "draco.glb")


def _meshopt(told: Any) -> Any:
    view = next(view for view in told["bufferViews"] if "extensions" in view)
    return view["extensions"]["EXT_meshopt_compression"]


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (lambda d: _meshopt(d).update(count=10**9), "another length"),
        (lambda d: _meshopt(d).update(count="x"), "no count"),
        (lambda d: _meshopt(d).update(mode="NOPE"), "layout"),
        (lambda d: _meshopt(d).update(byteLength=10**8), "past its buffer"),
        (lambda d: _meshopt(d).update(buffer=1), "without content"),
        (lambda d: _meshopt(d).update(byteLength=7), "damaged"),
        (
            lambda d: [
                view.update(byteLength=4 * 2**28) or _meshopt(d).update(count=2**28, byteStride=4)
                for view in [next(v for v in d["bufferViews"] if "extensions" in v)]
            ],
            "256 MB",
        ),
    ],
)
def test_what_cannot_be_decoded_is_refused_in_a_line(
    change: Any, what: str, tmp_path: Path
) -> None:
    path = tmp_path / "a.glb"
    path.write_bytes((HERE / "meshopt.glb").read_bytes())
    with pytest.raises(FormatError, match=what) as caught:
        read_gltf(edited(path, change))
    assert "\n" not in str(caught.value)


def _draco(told: Any) -> Any:
    return told["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]


@pytest.mark.parametrize(
    ("change", "what"),
    [
        (lambda d: _draco(d).update(attributes={"NORMAL": 1}), "no places"),
        (lambda d: _draco(d).update(attributes={"POSITION": 99}), "attribute 'POSITION'"),
        (lambda d: _draco(d).update(attributes={"POSITION": 2}), "does not fit"),
        (lambda d: _draco(d).update(bufferView=99), "bufferViews"),
        (lambda d: _draco(d).update(bufferView=[]), "bufferViews"),
        (lambda d: d["accessors"][0].update(count=7), "does not fit"),
        (lambda d: d["meshes"][0]["primitives"][0].pop("indices"), "accessors"),
    ],
)
def test_draco_that_does_not_fit_is_refused_in_a_line(
    change: Any, what: str, tmp_path: Path
) -> None:
    pytest.importorskip("DracoPy")
    path = tmp_path / "a.glb"
    path.write_bytes((HERE / "draco.glb").read_bytes())
    with pytest.raises(FormatError, match=what):
        read_gltf(edited(path, change))


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_damaged_files_are_refused_or_read(data: st.DataObject) -> None:
    pytest.importorskip("DracoPy")
    content = bytearray((HERE / data.draw(st.sampled_from(COMPRESSED))).read_bytes())
    for _ in range(data.draw(st.integers(1, 5))):
        content[data.draw(st.integers(12, len(content) - 1))] = data.draw(st.integers(0, 255))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "a.glb")
        path.write_bytes(content)
        with contextlib.suppress(MienError):
            read_gltf(path)


@needs_characters
def test_a_head_compressed_by_its_makers() -> None:
    model, plain = (read_gltf(DATA / "facecap" / f"facecap{way}.glb") for way in ("", "_plain"))
    np.testing.assert_allclose(model.vertices, plain.vertices, atol=1e-6)
    for shape, other in zip(model.shapes, plain.shapes, strict=True):
        assert shape.name == other.name
        np.testing.assert_allclose(model.dense(shape), plain.dense(other), atol=1e-6)
