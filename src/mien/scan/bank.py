"""Scans of one person's expressions become a databank [Z] §2."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from mien.errors import InputError
from mien.face.character import Character
from mien.face.databank import Databank
from mien.face.mesh import Mesh
from mien.scan.parameterise import ScanPoints, parameterise, parameterise_expression
from mien.scan.performer import expression_motion, over_eyes, performer_face, without
from mien.scan.surface import Surface
from mien.scan.template import face_template

Load = Callable[[], tuple[Mesh, ScanPoints]]
"""Gives a scan in millimetres and its points; called when the scan's turn has come, for scans are
large."""
Progress = Callable[[int, int], None]


def build_bank(
    generic: Character,
    name: str,
    neutral: Load,
    faces: Mapping[str, Load],
    progress: Progress | None = None,
) -> Databank:
    """A databank of ``faces`` by name, beside the person's ``neutral``, on the mesh of ``generic``
    with its skin refined twice.

    Raises InputError where there is no face, or where points cannot be a face's.
    """
    if not faces:
        raise InputError("a databank needs a neutral scan and one expression at least")
    tell = progress or (lambda done, expected: None)
    template = face_template(generic.face)
    scan, neutral_points = neutral()
    rest = parameterise(template, Surface(scan), neutral_points)
    if scan.colours is not None:
        generic = without(generic, "brow")
    face = performer_face(generic.face, template, rest, scan)
    face = replace(face, vertices=over_eyes(face, face.vertices))
    tell(1, len(faces) + 1)
    motions = np.empty((len(faces), *face.vertices.shape), dtype=np.float32)
    for row, (label, load) in enumerate(faces.items()):
        scan, points = load()
        try:
            done = parameterise_expression(template, rest, neutral_points, Surface(scan), points)
        except InputError as error:
            raise InputError(f"{label}: {error}") from error
        moved = face.vertices + expression_motion(generic, template, rest, done)
        motions[row] = over_eyes(face, moved) - face.vertices
        tell(row + 2, len(faces) + 1)
    return Databank(name, face, tuple(faces), motions)
