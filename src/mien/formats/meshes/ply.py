"""Scans in Stanford's PLY: text or binary, of either byte order, coloured or not.

A header names elements (vertex, face and whatever else) with their properties; lists carry their
own length. Every count is held against the bytes that are there before anything is allocated.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.errors import FormatError
from mien.face.face import Array
from mien.face.mesh import Mesh
from mien.formats.meshes.bounds import MAX_BYTES, linear_colours, sound_mesh, triangulated

_TYPES = {
    name: code
    for names, code in {
        "char int8": "i1", "uchar uint8": "u1", "short int16": "i2", "ushort uint16": "u2",
        "int int32": "i4", "uint uint32": "u4", "float float32": "f4", "double float64": "f8",
    }.items()
    for name in names.split()
}  # fmt: skip
_MAX_HEADER = 1 << 16
_MAX_CORNERS = 64
"""Corners of one polygon; a scan is made of triangles, and a longer list is damage."""

Bytes = NDArray[np.uint8]


@dataclass(frozen=True, slots=True)
class _Property:
    name: str
    item: str
    """numpy's code of its type, without byte order."""
    length: str | None
    """The code of a list's length, None for a single value."""


@dataclass(frozen=True, slots=True)
class _Element:
    name: str
    count: int
    properties: tuple[_Property, ...]

    @property
    def plain(self) -> bool:
        return all(p.length is None for p in self.properties)

    def smallest(self) -> int:
        """Bytes one row has at least."""
        return sum(np.dtype(p.length or p.item).itemsize for p in self.properties)


@dataclass(frozen=True, slots=True)
class _Header:
    order: str | None
    """ "<" or ">"; None for text."""
    elements: tuple[_Element, ...]
    unit: str
    size: int
    """Bytes of the header itself."""


def read_ply(path: Path) -> Mesh:
    """Read a triangle mesh; polygons are cut into fans, triangles that are none left out.

    The comment "units mm" tells the unit. Raises FormatError where the header is not
    one, where it promises more than is there, where faces name vertices that do not exist, and
    where there is no face at all.
    """
    try:
        if path.stat().st_size > MAX_BYTES:
            raise FormatError(f"{path}: larger than {MAX_BYTES >> 20} MB; thin the scan out first")
        data = path.read_bytes()
    except OSError as error:
        raise FormatError(f"{path}: cannot be read ({error.strerror})") from error
    header = _header(path, data)
    body = np.frombuffer(data, np.uint8)[header.size :]
    if header.order is None:
        rows = _text_elements(path, header, data[header.size :])
    else:
        rows = _binary_elements(path, header, body)
    return _mesh(path, header, rows)


def _header(path: Path, data: bytes) -> _Header:
    end = data.find(b"end_header", 0, _MAX_HEADER)
    if not data.startswith(b"ply") or end < 0:
        raise FormatError(f"{path}: not a PLY file (no 'ply' ... 'end_header')")
    newline = data.find(b"\n", end)
    if newline < 0:
        raise FormatError(f"{path}: the file ends with its header; export it again")
    order: str | None = ""
    unit = ""
    elements: list[tuple[str, int, list[_Property]]] = []
    for line in data[:end].decode("ascii", "replace").splitlines()[1:]:
        match line.split():
            case ["format", kind, _]:
                orders = {"ascii": None, "binary_little_endian": "<", "binary_big_endian": ">"}
                if kind not in orders:
                    raise FormatError(f"{path}: PLY of unknown format '{kind[:40]}'")
                order = orders[kind]
            case ["comment", "units", name]:
                unit = name[:20]
            case ["element", name, count] if count.isascii() and count.isdigit():
                elements.append((name, int(count), []))
            case ["property", "list", length, item, name] if (
                elements and _TYPES.get(length, "f")[0] in "iu" and item in _TYPES
            ):
                elements[-1][2].append(_Property(name, _TYPES[item], _TYPES[length]))
            case ["property", item, name] if elements and item in _TYPES:
                elements[-1][2].append(_Property(name, _TYPES[item], None))
            case [] | ["comment" | "obj_info", *_]:
                pass
            case _:
                raise FormatError(f"{path}: the header's line '{line[:60]}' means nothing in PLY")
    if order == "":
        raise FormatError(f"{path}: the header names no format; export it again")
    parts = tuple(_Element(name, count, tuple(rest)) for name, count, rest in elements)
    return _Header(order, parts, unit, newline + 1)


Rows = dict[str, dict[str, Any]]
"""By element and property: values (N,) of a plain element; of a list, pairs of rows (K,) and
members (K, n), one for each length n."""


def _binary_elements(path: Path, header: _Header, body: Bytes) -> Rows:
    rows: Rows = {}
    at = 0
    for element in header.elements:
        if element.count * element.smallest() > len(body) - at:
            raise FormatError(
                f"{path}: the header promises {element.count} of '{element.name}', "
                "more than the file holds; it was cut off, or its header is wrong"
            )
        if element.plain:
            kinds = [(f"p{i}", f"{header.order}{p.item}") for i, p in enumerate(element.properties)]
            table = np.frombuffer(body.data, np.dtype(kinds), element.count, at)
            rows[element.name] = {p.name: table[f"p{i}"] for i, p in enumerate(element.properties)}
            at += table.nbytes
        else:
            rows[element.name], at = _binary_lists(path, header, element, body, at)
    return rows


def _binary_lists(
    path: Path, header: _Header, element: _Element, body: Bytes, at: int
) -> tuple[dict[str, Any], int]:
    lengths = [np.dtype(p.length).itemsize if p.length else 0 for p in element.properties]
    items = [np.dtype(p.item).itemsize for p in element.properties]
    starts, counts, end = _walk(
        body, at, element.count, np.array(lengths), np.array(items), header.order == ">"
    )
    if end < 0:
        raise FormatError(
            f"{path}: a list in '{element.name}' runs past the end of the file or has more than "
            f"{_MAX_CORNERS} members; it was cut off, or its header is wrong"
        )
    found: dict[str, Any] = {}
    for i, p in enumerate(element.properties):
        if p.length is None:
            continue
        groups = []
        for n in np.unique(counts[:, i]):
            chosen = np.flatnonzero(counts[:, i] == n)
            width = int(n) * items[i]
            cells = body[starts[chosen, i, None] + np.arange(width)]
            groups.append((chosen, cells.view(f"{header.order}{p.item}")))
        found[p.name] = groups
    return found, int(end)


@njit(cache=True, nogil=True)
def _walk(
    body: Bytes, at: int, count: int, lengths: NDArray[Any], items: NDArray[Any], big: bool
) -> tuple[NDArray[np.int64], NDArray[np.int64], int]:
    """Where each list's members start and how many they are, (N, P) each, and where the element
    ends, -1 where it does not end well."""
    properties = len(items)
    starts = np.zeros((count, properties), np.int64)
    counts = np.zeros((count, properties), np.int64)
    for row in range(count):
        for p in range(properties):
            n = 1
            if lengths[p]:
                if at + lengths[p] > len(body):
                    return starts, counts, -1
                n = 0
                for k in range(lengths[p]):
                    byte = body[at + (k if big else lengths[p] - 1 - k)]
                    n = n * 256 + byte
                if n > _MAX_CORNERS:
                    return starts, counts, -1
                at += lengths[p]
            starts[row, p], counts[row, p] = at, n
            at += n * items[p]
            if at > len(body):
                return starts, counts, -1
    return starts, counts, at


def _text_elements(path: Path, header: _Header, text: bytes) -> Rows:
    try:
        numbers = np.array(text.split(), dtype=np.float64)
    except ValueError as error:
        raise FormatError(f"{path}: text where numbers should be ({error})"[:200]) from error
    rows: Rows = {}
    at = 0
    for element in header.elements:
        width = len(element.properties)
        if element.count * width > len(numbers) - at:
            raise FormatError(
                f"{path}: the header promises {element.count} of '{element.name}', "
                "more than the file holds; it was cut off, or its header is wrong"
            )
        if element.plain:
            table = numbers[at : at + element.count * width].reshape(element.count, width)
            rows[element.name] = {p.name: table[:, i] for i, p in enumerate(element.properties)}
            at += table.size
            continue
        lists = np.array([p.length is not None for p in element.properties])
        starts, counts, at = _walk_text(numbers, at, element.count, lists)
        if at < 0:
            raise FormatError(f"{path}: a list in '{element.name}' runs past the end of the file")
        rows[element.name] = {
            p.name: [
                (chosen, numbers[starts[chosen, i, None] + np.arange(n)])
                for n in np.unique(counts[:, i])
                for chosen in [np.flatnonzero(counts[:, i] == n)]
            ]
            for i, p in enumerate(element.properties)
            if lists[i]
        }
    return rows


@njit(cache=True, nogil=True)
def _walk_text(
    numbers: Array, at: int, count: int, lists: NDArray[np.bool_]
) -> tuple[NDArray[np.int64], NDArray[np.int64], int]:
    """As ``_walk``, in numbers instead of bytes."""
    starts = np.zeros((count, len(lists)), np.int64)
    counts = np.zeros((count, len(lists)), np.int64)
    for row in range(count):
        for p in range(len(lists)):
            n = 1
            if lists[p]:
                if at >= len(numbers) or not 0 <= numbers[at] <= _MAX_CORNERS:
                    return starts, counts, -1
                n = int(numbers[at])
                at += 1
            starts[row, p], counts[row, p] = at, n
            at += n
            if at > len(numbers):
                return starts, counts, -1
    return starts, counts, at


def _mesh(path: Path, header: _Header, rows: Rows) -> Mesh:
    vertex, face = rows.get("vertex", {}), rows.get("face", {})
    if not all(isinstance(vertex.get(axis), np.ndarray) for axis in "xyz"):
        raise FormatError(f"{path}: no vertices with x, y and z")
    lists = face.get("vertex_indices", face.get("vertex_index"))
    if not isinstance(lists, list) or not lists:
        raise FormatError(
            f"{path}: no faces, only points; make a surface of them first (MeshLab can)"
        )
    vertices = np.stack([vertex[axis] for axis in "xyz"], axis=1).astype(np.float64)
    return sound_mesh(
        path, vertices, triangulated(path, lists), _colours(header, vertex), header.unit
    )


def _colours(header: _Header, vertex: dict[str, Any]) -> Array | None:
    """(V, 3) linear RGB. Whole numbers are of 255, others of 1."""
    for prefix in ("", "diffuse_"):
        names = [f"{prefix}{colour}" for colour in ("red", "green", "blue")]
        if all(isinstance(vertex.get(name), np.ndarray) for name in names):
            element = next(e for e in header.elements if e.name == "vertex")
            kind = next(p.item for p in element.properties if p.name == names[0])
            screen = np.stack([vertex[name] for name in names], axis=1).astype(np.float64)
            return linear_colours(screen if kind[0] == "f" else screen / 255.0)
    return None
