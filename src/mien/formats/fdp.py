"""Feature points of a face of somebody else's, ``.fdp``: Xface's XML and Visage's lines.

Xface:  <xfdp> with <fapu> (raw lengths), <entity><mesh/><bind item submesh pivotX .../></entity>,
        <fdp name="2.1" affects="MESH" index="VERTEX"><indices/><influence fap type weight/></fdp>
Visage: # comments, a header ``1.0 NAME``, then  GROUP.INDEX X Y Z MESH.VERTEX

Both tie a point to a vertex of a mesh that is another file. Their influences are of their own
kinds; only the points are taken, ours are worked out from them (face.influence). Xface counts
FAPs from 0 there, and in its sample LeftEye has its pivot at minus x: sides are those of the
names.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError, InputError
from mien.face.face import FeaturePoints
from mien.vocabulary.fapu import Fapu
from mien.vocabulary.fdp import feature_points

Array = NDArray[np.float64]

MAX_BYTES = 8 << 20
MAX_POINTS = 4096
MAX_VERTEX = 100_000_000
LARGEST = 1e6
_UNITS = {"IRISD0": "iris", "ES0": "eyes", "ENS0": "nose", "MNS0": "philtrum", "MW0": "mouth"}
_AXES = "XYZ"


@dataclass(frozen=True, slots=True)
class TiedPoint:
    """A feature point at a vertex."""

    fdp: str
    """FDP id."""
    mesh: str
    vertex: int
    place: tuple[float, float, float] | None
    """Where the file says it lies, in the mesh's own unit and axes; Xface does not say."""


@dataclass(frozen=True, slots=True)
class FdpFile:
    """What a file tells of a face."""

    points: tuple[TiedPoint, ...]
    """In the file's order. A point may be there once for each of several meshes."""
    fapu: Fapu | None
    """Lengths in the mesh's own unit."""
    pivots: Mapping[str, Array]
    """(3,) by the name of the item bound there ("LeftEye")."""

    def on(self, mesh: str, first: int = 0) -> FeaturePoints:
        """The points on ``mesh``, whose vertices begin at ``first`` in a face."""
        mine = {point.fdp: point.vertex for point in self.points if point.mesh == mesh}
        vertices = np.repeat(np.array(list(mine.values()), dtype=np.int32)[:, None], 3, axis=1)
        weights = np.tile((1.0, 0.0, 0.0), (len(mine), 1))
        return FeaturePoints(tuple(mine), vertices + np.int32(first), weights)


def read_fdp(path: Path) -> FdpFile:
    """Read either kind. Raises InputError where there is no file, FormatError for a broken one."""
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
    except OSError as error:
        raise FormatError(f"{path}: cannot be read ({error.strerror})") from error
    if len(data) > MAX_BYTES:
        raise FormatError(f"{path}: larger than {MAX_BYTES >> 20} MiB; not a .fdp file")
    try:
        found = _xface(data) if data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] == b"<" else _visage(data)
    except (ElementTree.ParseError, UnicodeError, LookupError, ValueError) as error:
        raise FormatError(f"{path}: not a .fdp file, or a broken one ({error})") from error
    if not found.points:
        raise FormatError(f"{path}: it names no feature points")
    return found


def _xface(data: bytes) -> FdpFile:
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        raise ValueError("it declares entities of its own, which feature points need not")
    root = ElementTree.fromstring(data)
    if root.tag != "xfdp":
        raise ValueError(f"its root is <{root.tag[:40]}>, expected <xfdp>")
    points = tuple(
        _point(found.get("name", ""), found.get("affects", ""), found.get("index", ""), None)
        for found in root.iterfind("fdp")
    )
    units = root.find("head/fapu")
    pivots = {
        bound.get("item", ""): np.array([_number(bound.get(f"pivot{axis}", "")) for axis in _AXES])
        for bound in root.iterfind("source/entity/bind")
        if bound.get("pivotX") is not None
    }
    return FdpFile(_few(points), None if units is None else _fapu(units.attrib), pivots)


def _visage(data: bytes) -> FdpFile:
    points: list[TiedPoint] = []
    for line in data.decode("utf-8", errors="strict").splitlines():
        tokens = line.partition("#")[0].split()
        if len(tokens) != 5 or tokens[0] not in feature_points():
            if points and tokens:
                raise ValueError(f"'{line[:40]}' is no feature point")
            continue
        x, y, z = map(_number, tokens[1:4])
        mesh, dot, vertex = tokens[4].rpartition(".")
        points.append(_point(tokens[0], mesh if dot else "0", vertex, (x, y, z)))
    return FdpFile(_few(tuple(points)), None, {})


def _point(fdp: str, mesh: str, vertex: str, place: tuple[float, float, float] | None) -> TiedPoint:
    if fdp not in feature_points():
        raise ValueError(f"'{fdp[:24]}' is no feature point of MPEG-4")
    if not (vertex.isascii() and vertex.isdigit() and int(vertex[:12]) <= MAX_VERTEX):
        raise ValueError(f"point {fdp}: vertex '{vertex[:24]}' is no index")
    return TiedPoint(fdp, mesh, int(vertex), place)


def _few(points: tuple[TiedPoint, ...]) -> tuple[TiedPoint, ...]:
    if len(points) > MAX_POINTS:
        raise ValueError(f"more than {MAX_POINTS} points")
    return points


def _fapu(told: Mapping[str, str]) -> Fapu:
    return Fapu(**{name: _number(told.get(key, "")) for key, name in _UNITS.items()})


def _number(text: str) -> float:
    value = float(text)
    if not abs(value) <= LARGEST:
        raise ValueError(f"'{text[:24]}' is out of bounds")
    return value
