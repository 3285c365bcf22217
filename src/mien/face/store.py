"""Characters as files: one compressed .npz, small enough to ship and safe to open.

    about            uint8   JSON: format, version, name, parts, materials, points, pivots, keys
    vertices         float32 (V, 3) mm
    triangles        uint32  (T, 3) of all parts, in their order
    colours          uint8   (V, 3) sRGB-encoded albedo
    occlusion        uint8   (V,)
    uv               uint16  (V, 2) in steps of 1/65535, or (0, 2): none
    point_vertices   uint32  (P, 3), and point_weights float32 (P, 3)
    key_vertices     uint32  (M,) moved vertices of all key models, one key after the other
    key_steps        int16   (M, 3) their displacements in steps of the key's scale
    source           uint8   the GLB it was imported from, where it was (``face.driving``)

Only what a key model moves is kept. Steps are rounded to nearest, so mirrored displacements stay
mirrored.
"""

from __future__ import annotations

import io
import json
import math
import zipfile
import zlib
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError, InputError, OutputError
from mien.face.character import Character, KeyModels
from mien.face.driving import describe_driving, read_driving
from mien.face.face import FOLLOWS, Array, Face, FeaturePoints, Ints, Material, Part

FORMAT, VERSION = "mien character", 2
PIVOTS = ("head", "jaw", "eye_left", "eye_right")

_ARRAYS: dict[str, tuple[str, int]] = {
    "vertices": ("<f4", 3),
    "triangles": ("<u4", 3),
    "colours": ("|u1", 3),
    "occlusion": ("|u1", 0),
    "uv": ("<u2", 2),
    "point_vertices": ("<u4", 3),
    "point_weights": ("<f4", 3),
    "key_vertices": ("<u4", 0),
    "key_steps": ("<i2", 3),
}
_LARGEST_ENTRY = 128 * 2**20
_LARGEST_ABOUT = 2**20
_MOST_DISPLACEMENTS = 50_000_000
"""Key models times vertices: what a file may ask of memory once its key models are dense."""
_STEP = 0.001
"""mm, the finest step of a displacement; and what moves less than half of it stays out."""
_LARGEST_COORDINATE = 1e5
_BROKEN = (
    zipfile.BadZipFile,
    zlib.error,
    EOFError,
    ValueError,
    LookupError,
    TypeError,
    AttributeError,
    RuntimeError,
)
"""What zipfile, json and a description of the wrong shape raise on a file that is no character."""


def write_character(path: Path | str, character: Character) -> None:
    """Write ``character`` to ``path``. Raises OutputError."""
    path, face = Path(path), character.face
    rows, steps, scales = _pack_keys(character.keys)
    about = {
        "format": FORMAT,
        "version": VERSION,
        "name": character.name,
        "examples": list(character.examples),
        "parts": [
            {
                "name": part.name,
                "material": part.material,
                "first": part.first,
                "last": part.last,
                "follows": part.follows,
                "triangles": len(part.triangles),
            }
            for part in face.parts
        ],
        "materials": {
            name: {field: getattr(material, field) for field in Material.__slots__}
            for name, material in face.materials.items()
        },
        "driving": describe_driving(character) if character.whole else None,
        "points": list(face.points.ids),
        "pivots": {name: np.asarray(place).tolist() for name, place in face.pivots.items()},
        "keys": [
            {"name": name, "moved": len(moved), "scale": scale}
            for name, moved, scale in zip(character.keys.names, rows, scales, strict=True)
        ],
    }
    arrays: dict[str, NDArray[Any]] = {
        "vertices": face.vertices.astype("<f4"),
        "triangles": face.triangles.astype("<u4"),
        "colours": np.rint(_encode(face.colours) * 255).astype(np.uint8),
        "occlusion": np.rint(np.clip(face.occlusion, 0, 1) * 255).astype(np.uint8),
        "uv": np.rint(_uv(face) * 65535).astype("<u2"),
        "point_vertices": face.points.vertices.astype("<u4"),
        "point_weights": face.points.weights.astype("<f4"),
        "key_vertices": np.concatenate([np.empty(0, "<u4"), *rows]).astype("<u4"),
        "key_steps": np.concatenate([np.empty((0, 3), "<i2"), *steps]).astype("<i2"),
    }
    if character.origin is not None:
        arrays["source"] = np.frombuffer(character.origin.glb, np.uint8)
    text = np.frombuffer(json.dumps(about, sort_keys=True).encode(), np.uint8)
    beside = path.with_name(f".{path.name}.part")
    try:
        _write_archive(beside, {"about": text, **arrays})
        beside.replace(path)
    except OSError as error:
        beside.unlink(missing_ok=True)
        raise OutputError(f"{path}: cannot be written ({error.strerror or error})") from error


def read_character(path: Path | str) -> Character:
    """Read a character. Raises InputError where there is no file, FormatError where it is not
    a character or is broken."""
    path = Path(path)
    try:
        with zipfile.ZipFile(path) as archive:
            about = _read_about(archive)
            arrays = {
                name: _read_array(archive, name, dtype, columns)
                for name, (dtype, columns) in _ARRAYS.items()
            }
            glb = None
            if "source.npy" in archive.namelist():
                glb = _read_array(archive, "source", "|u1", 0).tobytes()
        return _assemble(about, arrays, glb)
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    except _BROKEN as error:
        what = str(error) or type(error).__name__
        raise FormatError(f"{path}: not a mien character, or a broken one ({what})") from error


def _uv(face: Face) -> Array:
    return np.zeros((0, 2)) if face.uv is None else np.clip(face.uv, 0.0, 1.0)


def _pack_keys(
    keys: KeyModels,
) -> tuple[list[NDArray[np.intp]], list[NDArray[np.int16]], list[float]]:
    rows, steps, scales = [], [], []
    for field in keys.displacements:
        reach = float(np.abs(field).max(initial=0.0))
        scale = max(_STEP, reach / 32767)
        counted = np.rint(field.astype(float) / scale).astype(np.int16)
        moved = np.flatnonzero(counted.any(axis=1))
        rows.append(moved)
        steps.append(counted[moved])
        scales.append(scale)
    return rows, steps, scales


def _unpack_keys(listed: list[Any], arrays: dict[str, NDArray[Any]], vertices: int) -> KeyModels:
    names = tuple(_text(key["name"]) for key in listed)
    counts = [_count(key["moved"], vertices) for key in listed]
    scales = [_number(key["scale"], 0.0, 1e3) for key in listed]
    rows, steps = arrays["key_vertices"], arrays["key_steps"]
    if len(set(names)) != len(names):
        raise ValueError("two key models of one name")
    if len(names) * vertices > _MOST_DISPLACEMENTS:
        raise ValueError("more key models than memory should hold")
    if len(rows) != sum(counts) or len(steps) != len(rows) or (rows >= vertices).any():
        raise ValueError("key models do not fit the vertices")
    displacements = np.zeros((len(names), vertices, 3), np.float32)
    ends = np.cumsum(counts, dtype=int)
    for key, (end, count, scale) in enumerate(zip(ends, counts, scales, strict=True)):
        run = slice(end - count, end)
        displacements[key, rows[run]] = steps[run] * np.float32(scale)
    return KeyModels(names, displacements)


def _assemble(
    about: dict[str, Any], arrays: dict[str, NDArray[Any]], glb: bytes | None
) -> Character:
    vertices = arrays["vertices"].astype(float)
    count = len(vertices)
    if not (np.abs(vertices) < _LARGEST_COORDINATE).all():
        raise ValueError("vertices beyond all bounds")
    if len(arrays["colours"]) != count or len(arrays["occlusion"]) != count:
        raise ValueError("colours and occlusion do not fit the vertices")
    if len(arrays["uv"]) not in (0, count):
        raise ValueError("texture coordinates do not fit the vertices")
    materials = {_text(name): _material(given) for name, given in about["materials"].items()}
    keys = _unpack_keys(about["keys"], arrays, count)
    examples = tuple(_text(name) for name in about["examples"])
    if not set(examples) <= set(keys.names):
        raise ValueError("an example is not among the key models")
    face = Face(
        vertices=vertices,
        parts=_parts(about["parts"], arrays["triangles"].astype(np.int32), count, materials),
        materials=materials,
        colours=_decode(arrays["colours"] / 255.0),
        occlusion=arrays["occlusion"] / 255.0,
        points=_points(about["points"], arrays, count),
        pivots={name: _place(about["pivots"][name]) for name in PIVOTS},
        uv=arrays["uv"] / 65535.0 if len(arrays["uv"]) else None,
    )
    driving = read_driving(about["driving"], glb) if about.get("driving") else {}
    return Character(_text(about["name"]), face, keys, examples, **driving)


def _parts(
    listed: list[Any], triangles: Ints, vertices: int, materials: dict[str, Material]
) -> tuple[Part, ...]:
    parts, first, row = [], 0, 0
    for given in listed:
        last = _count(given["last"], vertices)
        rows = triangles[row : row + _count(given["triangles"], len(triangles))]
        part = Part(
            _text(given["name"]), _text(given["material"]), first, last, rows, given["follows"]
        )
        if given["first"] != first or last < first or part.follows not in FOLLOWS:
            raise ValueError(f"part {part.name!r} is out of order")
        if part.material not in materials:
            raise ValueError(f"part {part.name!r} has no material")
        if rows.size and not (rows.min() >= first and rows.max() < last):
            raise ValueError(f"part {part.name!r} has triangles outside its vertices")
        parts.append(part)
        first, row = last, row + len(rows)
    if first != vertices or row != len(triangles) or not parts:
        raise ValueError("the parts do not add up to the mesh")
    if len({part.name for part in parts}) != len(parts):
        raise ValueError("two parts of one name")
    return tuple(parts)


def _points(listed: list[Any], arrays: dict[str, NDArray[Any]], vertices: int) -> FeaturePoints:
    ids = tuple(_text(name) for name in listed)
    corners, weights = arrays["point_vertices"], arrays["point_weights"].astype(float)
    if len(corners) != len(ids) or len(weights) != len(ids) or (corners >= vertices).any():
        raise ValueError("feature points do not fit the vertices")
    if not (np.abs(weights) < 1e3).all() or not np.allclose(weights.sum(axis=1), 1.0, atol=1e-4):
        raise ValueError("weights of feature points do not sum to 1")
    return FeaturePoints(
        ids, corners.astype(np.int32), weights / weights.sum(axis=1, keepdims=True)
    )


def _material(given: dict[str, Any]) -> Material:
    numbers = ("roughness", "specular", "subsurface", "emission")
    return Material(
        **{name: _number(given[name], 0.0, 10.0) for name in numbers},
        casts_shadow=bool(given["casts_shadow"]),
    )


def _text(value: object) -> str:
    if not isinstance(value, str) or not 0 < len(value) <= 200:
        raise ValueError("a name is missing or too long")
    return value


def _count(value: object, most: int) -> int:
    if type(value) is not int or not 0 <= value <= most:
        raise ValueError("a count is out of bounds")
    return value


def _number(value: object, least: float, most: float) -> float:
    if type(value) not in (int, float) or not least <= value <= most:  # type: ignore[operator]
        raise ValueError("a number is out of bounds")
    return float(value)  # type: ignore[arg-type]


def _place(value: list[Any]) -> Array:
    if len(value) != 3:
        raise ValueError("a pivot is not a place")
    return np.array([_number(x, -_LARGEST_COORDINATE, _LARGEST_COORDINATE) for x in value])


def _encode(linear: Array) -> Array:
    linear = np.clip(linear, 0.0, 1.0)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def _decode(encoded: Array) -> Array:
    return np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)


def _write_archive(path: Path, arrays: dict[str, NDArray[Any]]) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=9) as archive:
        for name, array in arrays.items():
            held = io.BytesIO()
            np.lib.format.write_array(held, np.ascontiguousarray(array), allow_pickle=False)
            # A fixed date: the same character is the same file.
            entry = zipfile.ZipInfo(f"{name}.npy", date_time=(1980, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, held.getvalue(), compresslevel=9)


def _read_array(
    archive: zipfile.ZipFile, name: str, dtype: str, columns: int, most: int = _LARGEST_ENTRY
) -> NDArray[Any]:
    """One array, believed only as far as its bytes go: a header may promise any shape."""
    with archive.open(f"{name}.npy") as entry:
        held = io.BytesIO(entry.read(most + 1))
    if held.getbuffer().nbytes > most:
        raise ValueError(f"{name} is larger than any character's")
    if np.lib.format.read_magic(held) != (1, 0):
        raise ValueError(f"{name} has an unknown header")
    shape, fortran, found = np.lib.format.read_array_header_1_0(held)
    content = held.read()
    wanted = () if columns == 0 else (columns,)
    if found != np.dtype(dtype) or fortran or not shape or shape[1:] != wanted:
        raise ValueError(f"{name} has another type or shape than it should")
    if math.prod(shape) * found.itemsize != len(content):
        raise ValueError(f"{name} is cut short")
    return np.frombuffer(content, found).reshape(shape)


def _read_about(archive: zipfile.ZipFile) -> dict[str, Any]:
    about = json.loads(_read_array(archive, "about", "|u1", 0, _LARGEST_ABOUT).tobytes())
    if not isinstance(about, dict) or about.get("format") != FORMAT:
        raise ValueError("no description of a character in it")
    if about.get("version") != VERSION:
        raise ValueError(f"version {about.get('version')!r}, this mien reads version {VERSION}")
    return about
