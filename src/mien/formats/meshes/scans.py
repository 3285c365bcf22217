"""Scans from files, in millimetres and upright."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from mien.errors import FormatError, InputError
from mien.face.face import Array
from mien.face.mesh import Mesh
from mien.formats.meshes.bounds import sound_mesh
from mien.formats.meshes.lengths import millimetres
from mien.formats.meshes.obj_read import read_obj
from mien.formats.meshes.ply import read_ply

ENDINGS = (".ply", ".obj")
AXES = ("+x", "-x", "+y", "-y", "+z", "-z")


def read_scan(path: Path, units: str | None = None) -> tuple[Mesh, float]:
    """A scan in millimetres, in its own axes, and the millimetres in its file's unit.

    ``units`` is a name (mm, cm, m, in) or a number of millimetres; None: the file's own. Raises
    InputError where there is no such file, FormatError where it is broken or its unit unknown.
    """
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        raise InputError(f"{path}: no scan; there are {', '.join(ENDINGS)}")
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    if ending == ".ply":
        mesh = read_ply(path)
    else:
        told = read_obj(path)
        mesh = sound_mesh(path, told.vertices, told.triangles, None)
    unit = _unit(path, mesh, units)
    return replace(mesh, vertices=unit * mesh.vertices, unit="mm"), unit


def stand(up: str, front: str) -> Array:
    """(3, 3) turn that takes a scan whose head points to ``up`` and looks to ``front`` (each one
    of AXES) upright. Raises InputError where they are on one line."""
    above, ahead = _axis(up), _axis(front)
    if above @ ahead:
        raise InputError(f"--up {up} --front {front}: a face cannot look along its own height")
    return np.stack([np.cross(above, ahead), above, ahead])


def _axis(name: str) -> Array:
    axis = np.zeros(3)
    axis["xyz".index(name[1])] = 1.0 if name[0] == "+" else -1.0
    return axis


def _unit(path: Path, mesh: Mesh, units: str | None) -> float:
    try:
        number = float(units or "")
    except ValueError:
        return millimetres(path, mesh.unit, units, mesh.vertices)
    if not (math.isfinite(number) and number > 0.0):
        raise FormatError(f"--units {units}: not millimetres above 0, nor mm, cm, m or in")
    return number
