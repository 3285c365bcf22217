"""ZIP archives of one JSON header and ``.npy`` arrays, believed only as far as their bytes go."""

from __future__ import annotations

import json
import zipfile
import zlib
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

HEADER = "mien.json"

DAMAGE = (
    zipfile.BadZipFile,
    zlib.error,
    OSError,
    EOFError,
    KeyError,
    ValueError,
    TypeError,
    SyntaxError,
    OverflowError,
    RuntimeError,
    MemoryError,
)
"""What zipfile, json and numpy raise on bytes that are not what they say."""


def entry(name: str) -> zipfile.ZipInfo:
    """A compressed entry with a fixed date: the same content gives the same bytes."""
    made = zipfile.ZipInfo(name)
    made.compress_type = zipfile.ZIP_DEFLATED
    return made


def read_header(archive: zipfile.ZipFile, kind: str, what: str, most: int) -> dict[str, Any]:
    """The header of an archive of that ``kind``, at most ``most`` bytes; ``what`` it should hold,
    for the message. Raises ValueError, or another of DAMAGE."""
    with archive.open(HEADER) as stream:
        text = stream.read(most + 1)
    if len(text) > most:
        raise ValueError("its header is too long")
    header = json.loads(text)
    if not isinstance(header, dict) or header.get("format") != kind:
        raise ValueError(f"it holds no {what}")
    return header


def read_array(
    archive: zipfile.ZipFile, name: str, shape: tuple[int, ...], dtype: str = "<f8"
) -> NDArray[Any]:
    """The array ``name``, which has to be of just that ``shape`` and ``dtype``; nothing larger is
    unpacked. Raises ValueError, or another of DAMAGE."""
    kind = np.dtype(dtype)
    with archive.open(f"{name}.npy") as stream:
        if np.lib.format.read_magic(stream) != (1, 0):
            raise ValueError(f"'{name}' is not an array of version 1.0")
        found, fortran, stored = np.lib.format.read_array_header_1_0(stream)
        if found != shape or stored != kind or (fortran and len(shape) > 1):
            raise ValueError(f"'{name}' is {stored} {found}, expected {kind} {shape}")
        size = prod(shape) * kind.itemsize
        data = bytearray(stream.read(size + 1))
    if len(data) != size:
        raise ValueError(f"'{name}' has {len(data)} bytes, expected {size}")
    if kind == np.dtype(bool) and size and max(data) > 1:
        raise ValueError(f"'{name}' is not true or false")
    return np.frombuffer(data, dtype=kind).astype(kind.newbyteorder("="), copy=False).reshape(shape)


def first_line(error: BaseException) -> str:
    """What went wrong, short enough for a message."""
    return (str(error).strip("'\"") or type(error).__name__).splitlines()[0][:200]
