"""The performer file, ``.performer``: what earlier takes told of somebody.

A ZIP of one JSON header and one ``.npy`` array (float64, C order) a number or table, named
"section/name". A held face n has three arrays of the section "held": "n.motion", "n.unseen" and
"n.lids"; the header says what it stands for. Nothing in it is executed or trusted.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError, InputError
from mien.formats.archive import DAMAGE, HEADER, entry, first_line, read_array, read_header
from mien.formats.atomic import whole_file
from mien.performance.performer import HeldFace, Performer

Array = NDArray[np.float64]

FORMAT = "mien performer"
VERSION = 1
SECTIONS = ("landmarks", "curves", "poses")
HELD = "held"

MAX_ARRAYS = 1024
MAX_NUMBERS = 1 << 20
"""In one array, and eight times as many in all."""
MAX_HEADER_BYTES = 1 << 18
MAX_TEXT = 4096
MAX_HELD = 128
MAX_POSE = 256

_HELD_SHAPES: Mapping[str, tuple[int, ...]] = {"motion": (3,), "unseen": (3,), "lids": (2,)}
"""Last axes of what is kept of a held face."""


def write_performer(performer: Performer, path: Path) -> None:
    """Write ``path`` whole or not at all; every number is kept to the bit. Raises OutputError."""
    arrays = {
        f"{section}/{name}": np.asarray(array, dtype="<f8", order="C")
        for section in SECTIONS
        for name, array in getattr(performer, section).items()
    }
    for number, face in enumerate(performer.held):
        for field in _HELD_SHAPES:
            array = np.asarray(getattr(face, field), dtype="<f8", order="C")
            arrays[f"{HELD}/{number}.{field}"] = array
    header = {
        "format": FORMAT,
        "version": VERSION,
        "source": performer.source[:MAX_TEXT],
        "held": [
            {"capture": face.capture, "character": face.character, "pose": dict(face.pose)}
            for face in performer.held
        ],
        "arrays": {name: list(array.shape) for name, array in arrays.items()},
    }
    with whole_file(path) as temporary, zipfile.ZipFile(temporary, "w") as archive:
        archive.writestr(entry(HEADER), json.dumps(header, indent=1))
        for name, array in arrays.items():
            with archive.open(entry(f"{name}.npy"), "w") as stream:
                np.lib.format.write_array(stream, array, allow_pickle=False)


def read_performer(path: Path) -> Performer:
    """Read a ``.performer`` file. Raises InputError where there is none, FormatError for anything
    but a whole, sane one."""
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    try:
        with zipfile.ZipFile(path) as archive:
            header = _read_header(archive)
            arrays = {
                name: _read_finite(archive, name, tuple(shape))
                for name, shape in header["arrays"].items()
            }
            held = tuple(_held(arrays, n, told) for n, told in enumerate(header.get("held", [])))
    except DAMAGE as error:
        raise FormatError(
            f"{path}: not a whole .performer file ({first_line(error)}); calibrate again"
        ) from error
    sections: dict[str, dict[str, Array]] = {name: {} for name in SECTIONS}
    for name, array in arrays.items():
        section, _, rest = name.partition("/")
        if section != HELD:
            sections[section][rest] = array
    return Performer(**sections, held=held, source=header["source"])


def _held(arrays: Mapping[str, Array], number: int, told: Any) -> HeldFace:
    found = {field: arrays[f"{HELD}/{number}.{field}"] for field in _HELD_SHAPES}
    for field, shape in _HELD_SHAPES.items():
        if found[field].shape[-len(shape) :] != shape or found[field].ndim > 2:
            raise ValueError(f"'{field}' of a held face has another shape")
    pose = told["pose"]
    words = isinstance(told["capture"], str) and isinstance(told["character"], str)
    if not words or not isinstance(pose, dict) or not 0 < len(pose) <= MAX_POSE:
        raise ValueError("a held face stands for nothing")
    levels = {name: float(level) for name, level in pose.items()}
    if not all(0.0 <= level <= 2.0 for level in levels.values()):
        raise ValueError("a held face has weights beyond 0 to 2")
    return HeldFace(told["capture"], told["character"], levels, **found)


def _read_header(archive: zipfile.ZipFile) -> dict[str, Any]:
    header = read_header(archive, FORMAT, "performer", MAX_HEADER_BYTES)
    if header.get("version") != VERSION:
        raise ValueError(f"its version is not {VERSION}; update mien")
    if not isinstance(header.get("source"), str) or len(header["source"]) > MAX_TEXT:
        raise ValueError("'source' in its header is not a short text")
    held = header.get("held", [])
    if not isinstance(held, list) or len(held) > MAX_HELD:
        raise ValueError("'held' in its header is not a short list")
    arrays = header.get("arrays")
    if not isinstance(arrays, dict) or len(arrays) > MAX_ARRAYS:
        raise ValueError("'arrays' in its header is not a short table")
    for name, shape in arrays.items():
        section, slash, rest = name.partition("/")
        if section not in (*SECTIONS, HELD) or not slash or not 0 < len(rest) <= 64:
            raise ValueError("it has an array of no section")
        whole = isinstance(shape, list) and len(shape) <= 4
        if not whole or any(type(n) is not int or n < 0 for n in shape):
            raise ValueError(f"'{name[:64]}' has no shape")
        if prod(shape) > MAX_NUMBERS:
            raise ValueError(f"'{name[:64]}' is too large")
    if sum(prod(shape) for shape in arrays.values()) > 8 * MAX_NUMBERS:
        raise ValueError("it is too large")
    return header


def _read_finite(archive: zipfile.ZipFile, name: str, shape: tuple[int, ...]) -> Array:
    array = read_array(archive, name, shape)
    if not np.isfinite(array).all():
        raise ValueError(f"'{name}' holds numbers that are not finite")
    return array
