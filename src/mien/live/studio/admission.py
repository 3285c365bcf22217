"""Characters that somebody brings: read under the importers' bounds, and admitted to the troupe.

A face that is not found by looking is shown as it is, for somebody to point at its features.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from mien.errors import FormatError, MissingExtraError, NoFaceError
from mien.face.character import Character
from mien.face.library import CHARACTERS as BUILT_IN
from mien.face.store import write_character
from mien.formats.gltf.buffer import GltfBuffer
from mien.formats.unpack import unpack
from mien.live.studio.shelf import CHARACTERS, MODELS, POINTS, Shelf
from mien.numeric.normals import vertex_normals
from mien.rig.importer import ANY_SIZE, import_character, read_model
from mien.rig.picks import write_picks
from mien.rig.sight import framed
from mien.sculpt.transfer.make import make
from mien.sculpt.transfer.shapes import driven, shape_sets, source_of

_FEWEST = 3
"""Key models a face must bring to act by its own."""
_WHOLE = (".vrm", ".glb", ".gltf")
_MADE = "mien"
"""Set of key models that is made for a face that has none."""


@dataclass(frozen=True, slots=True)
class Admitted:
    """Somebody new, or the reason why nobody's face was found."""

    name: str
    found: bool
    notes: tuple[str, ...]


def admit(shelf: Shelf, model: str, picks: Mapping[str, Sequence[float]] | None) -> Admitted:
    """Take the uploaded ``model`` into the troupe; ``picks`` are feature points (x, y, z) in its
    own coordinates, found by looking where there are none. Raises InputError, FormatError,
    OutputError."""
    path = shelf.there(model, MODELS)
    name = path.stem if path.stem not in BUILT_IN else f"my {path.stem}"
    points: Path | None = None
    if picks is not None:
        points = shelf.place(f"{name}.toml", POINTS)
        write_picks(points, picks)
    with _opened(path) as source:
        try:
            found = import_character(source, points=points, units=ANY_SIZE, name=name)
        except (NoFaceError, MissingExtraError) as error:
            return Admitted(name, False, (str(error).partition(": ")[2] or str(error),))
    character, notes = found.character, found.notes
    if len(character.examples) < _FEWEST:
        character, notes = _taught(character), (*notes, "its key models were made for it")
    write_character(shelf.place(f"{name}.character", CHARACTERS), character)
    return Admitted(name, True, notes)


def as_it_is(shelf: Shelf, model: str) -> bytes:
    """The uploaded ``model`` as a plain GLB in its own coordinates, to point at. Raises as
    ``admit``."""
    with _opened(shelf.there(model, MODELS)) as source:
        read = read_model(source)
    vertices, triangles = read.vertices, read.triangles
    colours = np.concatenate([part.colours for part in read.parts])
    low, high = (end.tolist() for end in framed(read, vertices))
    face = {"low": low, "high": high, "facing": read.forward or 1}
    buffer = GltfBuffer()
    primitive = {
        "attributes": {
            "POSITION": buffer.add(vertices.astype(np.float32), "vertex", bounds=True),
            "NORMAL": buffer.add(vertex_normals(vertices, triangles).astype(np.float32), "vertex"),
            "COLOR_0": buffer.add(np.clip(colours, 0.0, 1.0).astype(np.float32), "vertex"),
        },
        "indices": buffer.add(triangles.ravel().astype(np.uint32), "element"),
    }
    return buffer.glb(
        {
            "asset": {"version": "2.0", "generator": "mien"},
            "scene": 0,
            "scenes": [{"nodes": [0], "extras": {"face": face}}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [primitive]}],
        }
    )


def _taught(character: Character) -> Character:
    """A face that cannot act, with key models that are made for it."""
    chosen = shape_sets()[_MADE]
    made = make(character.face, source_of(chosen), chosen.names, character.name)
    return driven(made.character, _MADE)


@contextmanager
def _opened(path: Path) -> Iterator[Path]:
    """The file or folder that holds the character. Raises FormatError."""
    if path.suffix.lower() != ".zip":
        yield path
        return
    with tempfile.TemporaryDirectory(prefix="mien-") as folder:
        unpack(path, Path(folder))
        yield _inside(Path(folder), path.name)


def _inside(folder: Path, name: str) -> Path:
    """The character in an unpacked archive: a whole file, or the fullest folder of OBJ files."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    for ending in _WHOLE:
        whole = [path for path in files if path.suffix.lower() == ending]
        if whole:
            return whole[0]
    meshes = [path for path in files if path.suffix.lower() == ".obj"]
    if not meshes:
        raise FormatError(f"{name}: no character in it; put one GLB, VRM, glTF, or OBJ files in")
    if len(meshes) == 1:
        return meshes[0]
    folders = [path.parent for path in meshes]
    return max(dict.fromkeys(folders), key=folders.count)
