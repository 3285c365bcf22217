"""The performer file, ``.performer``: what earlier takes told of somebody.

A ZIP of one JSON header and one ``.npy`` array (float64, C order) a number or table, named
"section/name". Nothing in it is executed or trusted.
"""

from __future__ import annotations

import json
import zipfile
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError, InputError
from mien.formats.archive import DAMAGE, HEADER, entry, first_line, read_array, read_header
from mien.formats.atomic import whole_file
from mien.performance.performer import Performer

FORMAT = "mien performer"
VERSION = 1
SECTIONS = ("landmarks", "curves", "poses")

MAX_ARRAYS = 512
MAX_NUMBERS = 1 << 20
"""In one array, and eight times as many in all."""
MAX_HEADER_BYTES = 1 << 18
MAX_TEXT = 4096


def write_performer(performer: Performer, path: Path) -> None:
    """Write ``path`` whole or not at all; every number is kept to the bit. Raises OutputError."""
    arrays = {
        f"{section}/{name}": np.asarray(array, dtype="<f8", order="C")
        for section in SECTIONS
        for name, array in getattr(performer, section).items()
    }
    header = {
        "format": FORMAT,
        "version": VERSION,
        "source": performer.source[:MAX_TEXT],
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
    except DAMAGE as error:
        raise FormatError(
            f"{path}: not a whole .performer file ({first_line(error)}); calibrate again"
        ) from error
    sections: dict[str, dict[str, NDArray[np.float64]]] = {name: {} for name in SECTIONS}
    for name, array in arrays.items():
        section, _, rest = name.partition("/")
        sections[section][rest] = array
    return Performer(**sections, source=header["source"])


def _read_header(archive: zipfile.ZipFile) -> dict[str, Any]:
    header = read_header(archive, FORMAT, "performer", MAX_HEADER_BYTES)
    if header.get("version") != VERSION:
        raise ValueError(f"its version is not {VERSION}; update mien")
    if not isinstance(header.get("source"), str) or len(header["source"]) > MAX_TEXT:
        raise ValueError("'source' in its header is not a short text")
    arrays = header.get("arrays")
    if not isinstance(arrays, dict) or len(arrays) > MAX_ARRAYS:
        raise ValueError("'arrays' in its header is not a short table")
    for name, shape in arrays.items():
        section, slash, rest = name.partition("/")
        if section not in SECTIONS or not slash or not 0 < len(rest) <= 64:
            raise ValueError("it has an array of no section")
        whole = isinstance(shape, list) and len(shape) <= 4
        if not whole or any(type(n) is not int or n < 0 for n in shape):
            raise ValueError(f"'{name[:64]}' has no shape")
        if prod(shape) > MAX_NUMBERS:
            raise ValueError(f"'{name[:64]}' is too large")
    if sum(prod(shape) for shape in arrays.values()) > 8 * MAX_NUMBERS:
        raise ValueError("it is too large")
    return header


def _read_finite(
    archive: zipfile.ZipFile, name: str, shape: tuple[int, ...]
) -> NDArray[np.float64]:
    array = read_array(archive, name, shape)
    if not np.isfinite(array).all():
        raise ValueError(f"'{name}' holds numbers that are not finite")
    return array
