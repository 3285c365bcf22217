"""A character from a folder of OBJ files: one is the neutral, every other one shape.

    base.obj or neutral.obj        the face at rest; also a name that ends in "neutral_mesh"
    smile.obj, morph0.obj ...      the same vertices in the same order, moved

ICT-FaceKit's folder is such a one; its identities are not shapes and are left out.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from mien.errors import FormatError, InputError
from mien.face.face import Array
from mien.face.model import Model, ModelPart, Shape
from mien.formats.meshes.obj_read import ObjMesh, read_obj

_NEUTRAL = re.compile(r"^(base|neutral|rest|basis)$|neutral(_mesh)?$", re.IGNORECASE)
_IDENTITY = re.compile(r"^identity\d+$", re.IGNORECASE)
_MAX_FILES, _MAX_DISPLACEMENTS = 2000, 25_000_000
_PLAIN = (0.45, 0.4, 0.36)
_LONGEST_STEP = 0.5
"""Part of the face's size: where half of the vertices move farther, they are in another order."""


def read_obj_model(path: Path) -> Model:
    """One OBJ file: a face without shapes. Raises InputError, FormatError."""
    mesh = read_obj(path)
    return Model(path.stem, (_part(path, mesh),), ())


def read_folder(path: Path) -> Model:
    """A folder of OBJ files. Raises InputError, FormatError naming the file that does not fit."""
    files = sorted(path.glob("*.obj"), key=_natural)
    if not files:
        raise InputError(f"{path}: no OBJ files in this folder")
    if len(files) > _MAX_FILES:
        raise FormatError(f"{path}: more than {_MAX_FILES} OBJ files; split the folder")
    neutral = [file for file in files if _NEUTRAL.search(file.stem)]
    if len(neutral) != 1:
        raise InputError(
            f"{path}: {len(neutral)} files could be the neutral; call it neutral.obj, and no other"
        )
    mesh = read_obj(neutral[0])
    moved = [f for f in files if f != neutral[0] and not _IDENTITY.match(f.stem)]
    if len(moved) * len(mesh.vertices) > _MAX_DISPLACEMENTS:
        raise FormatError(f"{path}: more shapes than memory should hold; reduce the mesh")
    left_out = len(files) - 1 - len(moved)
    shapes = []
    for file in moved:
        field = _displacement(file, read_obj(file), mesh)
        shapes.append(Shape(file.stem, {0: field.astype(np.float32)} if field.any() else {}))
    notes = (f"{left_out} identities are not shapes: left out",) if left_out else ()
    name = path.name if path.name != "obj" else path.resolve().parent.name
    return Model(name, (_part(neutral[0], mesh),), tuple(shapes), notes=notes)


def _part(path: Path, mesh: ObjMesh) -> ModelPart:
    if not len(mesh.triangles):
        raise FormatError(f"{path}: no faces in it; export the mesh with its faces")
    corners = mesh.vertices[mesh.triangles]
    area = np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    if not area.any():
        raise FormatError(f"{path}: not one face has an area; export it again")
    colours = np.tile(_PLAIN, (len(mesh.vertices), 1))
    return ModelPart(path.stem, mesh.vertices, mesh.triangles.astype(np.int32), colours)


def _displacement(path: Path, shape: ObjMesh, neutral: ObjMesh) -> Array:
    if len(shape.vertices) != len(neutral.vertices):
        raise FormatError(
            f"{path}: {len(shape.vertices)} vertices, but the neutral has {len(neutral.vertices)};"
            " export all with the same vertices"
        )
    field = shape.vertices - neutral.vertices
    size = float(np.linalg.norm(np.ptp(neutral.vertices, axis=0)))
    shuffled = len(shape.triangles) and not np.array_equal(shape.triangles, neutral.triangles)
    if shuffled or np.median(np.linalg.norm(field, axis=1)) > _LONGEST_STEP * size:
        raise FormatError(
            f"{path}: its vertices are in another order than the neutral's; export all with the"
            " order kept"
        )
    return field


def _natural(path: Path) -> list[tuple[bool, int, str]]:
    runs = re.findall(r"[0-9]+|[^0-9]+", path.stem.lower())
    return [(run.isdigit(), int(run) if run.isdigit() else 0, run) for run in runs]
