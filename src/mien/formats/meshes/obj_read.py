"""A mesh from a Wavefront OBJ file, none of it believed."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError, InputError
from mien.face.face import Array
from mien.formats.meshes.bounds import triangulated

MAX_BYTES = 64 * 2**20
_FARTHEST = 1e7
_MAX_CORNERS = 64


@dataclass(frozen=True, slots=True)
class ObjMesh:
    """What an OBJ file says of a shape; polygons are cut into fans."""

    vertices: Array
    """(V, 3)"""
    triangles: NDArray[np.int64]
    """(T, 3), (0, 3) where the file has no faces."""
    groups: tuple[tuple[str, int], ...]
    """Names of objects and groups, and the first triangle of each."""


def read_obj(path: Path) -> ObjMesh:
    """Read vertices and faces. Raises InputError where there is no file, FormatError."""
    try:
        if path.stat().st_size > MAX_BYTES:
            raise FormatError(f"{path}: at most {MAX_BYTES >> 20} MB can be read; reduce the mesh")
        text = path.read_bytes().decode("utf-8", "replace")
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    places: list[list[str]] = []
    polygons: list[list[int]] = []
    groups: list[tuple[str, int]] = []
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.split()
        if not words:
            continue
        if words[0] == "v":
            places.append(words[1:4])
        elif words[0] == "f":
            polygons.append(_corners(path, number, words[1:], len(places)))
        elif words[0] in ("o", "g") and len(words) > 1:
            groups.append((words[1][:120], len(polygons)))
    return ObjMesh(_vertices(path, places), *_fans(path, polygons, groups, len(places)))


def _vertices(path: Path, places: list[list[str]]) -> Array:
    if not places:
        raise FormatError(f"{path}: no vertices in it; export it again")
    try:
        vertices = np.array(places, dtype=float)
    except ValueError as error:
        raise FormatError(f"{path}: a vertex is not three numbers; export it again") from error
    if vertices.shape[1:] != (3,) or not (np.abs(vertices) < _FARTHEST).all():
        raise FormatError(f"{path}: a vertex is beyond all bounds; export it again")
    if not np.ptp(vertices, axis=0).any():
        raise FormatError(f"{path}: all vertices lie in one place; export it again")
    return vertices


def _corners(path: Path, line: int, words: list[str], known: int) -> list[int]:
    """Vertices of a polygon; negative numbers count back from the last vertex so far."""
    try:
        found = [int(word.partition("/")[0]) for word in words]
    except ValueError as error:
        raise FormatError(f"{path}, line {line}: a face is not numbers; export it again") from error
    if not 3 <= len(found) <= _MAX_CORNERS:
        raise FormatError(f"{path}, line {line}: a face of {len(found)} corners; export it again")
    corners = [corner - 1 if corner > 0 else known + corner for corner in found]
    if 0 in found or min(corners) < 0:
        raise FormatError(f"{path}, line {line}: a face names a vertex that is not there")
    return corners


def _fans(
    path: Path, polygons: list[list[int]], groups: list[tuple[str, int]], vertices: int
) -> tuple[NDArray[np.int64], tuple[tuple[str, int], ...]]:
    if not polygons:
        return np.zeros((0, 3), np.int64), ()
    sizes = np.array([len(polygon) for polygon in polygons])
    if max(max(polygon) for polygon in polygons) >= vertices:
        raise FormatError(f"{path}: a face names a vertex that is not among the {vertices}")
    by_size = [
        (np.flatnonzero(sizes == size), np.array([p for p in polygons if len(p) == size]))
        for size in np.unique(sizes)
    ]
    triangles = triangulated(path, by_size)
    first = np.concatenate([[0], np.cumsum(sizes - 2)])
    return triangles, tuple((name, int(first[polygon])) for name, polygon in groups)
