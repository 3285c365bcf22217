"""The performance file, ``.mien``: documented in docs/performance_file.md.

A ZIP of one JSON header and one ``.npy`` array a field, so that any tool with NumPy reads it
(``numpy.load(path)["motion"]``). Nothing in it is executed or trusted.
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Mapping
from dataclasses import fields
from math import isfinite, prod
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError, InputError
from mien.formats.archive import DAMAGE, HEADER, entry, first_line, read_array, read_header
from mien.formats.atomic import whole_file
from mien.performance.performance import Performance, Span

FORMAT = "mien performance"
VERSION = 1

MAX_FRAMES = 1_000_000
MAX_POINTS = 4096
MAX_NAMES = 1024
MAX_TEXT = 4096
MAX_HEADER_BYTES = 1 << 20
MAX_BYTES = 1 << 30
"""Of all arrays together: an hour of 84 points at 60 frames a second is half of it."""

SHAPES: Mapping[str, tuple[str | int, ...]] = {
    "time": ("F",),
    "neutral": ("P", 3),
    "motion": ("F", "P", 3),
    "sigma": ("P", 3),
    "rotation": ("F", 3, 3),
    "translation": ("F", 3),
    "gaze": ("F", 2, 2),
    "confidence": ("F",),
    "lost": ("F",),
    "unseen": ("F", 3),
    "rest_rotation": (3, 3),
    "rest_translation": (3,),
    "shapes": ("G", "K"),
}
"""Arrays by field of Performance; G is F where a vocabulary is spoken and 0 where not."""


def write_performance(performance: Performance, path: Path) -> None:
    """Write ``path`` whole or not at all; every number is kept to the bit. Raises OutputError."""
    header = {
        "format": FORMAT,
        "version": VERSION,
        "units": {"length": "mm", "angle": "rad", "time": "s"},
        "frames": len(performance),
        "points": list(performance.points),
        "spans": [
            {"first": s.first, "second": s.second, "axis": s.axis, "sigma": s.sigma}
            for s in performance.spans
        ],
        "scalars": sorted(performance.scalars),
        "vocabulary": performance.vocabulary,
        "weights": int(performance.shapes.shape[1]),
        "source": performance.source[:MAX_TEXT],
        "faces": performance.faces,
    }
    arrays = {name: getattr(performance, name) for name in SHAPES}
    arrays |= {f"scalars/{name}": value for name, value in performance.scalars.items()}
    with (
        whole_file(path) as temporary,
        zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
    ):
        archive.writestr(entry(HEADER), json.dumps(header, indent=1))
        for name, array in arrays.items():
            with archive.open(entry(f"{name}.npy"), "w", force_zip64=True) as stream:
                kind = np.dtype(bool if name == "lost" else "<f8")
                np.lib.format.write_array(
                    stream, np.ascontiguousarray(array, dtype=kind), allow_pickle=False
                )


def read_performance(path: Path) -> Performance:
    """Read a ``.mien`` file. Raises InputError where there is none, FormatError for anything but
    a whole, sane one."""
    if not path.is_file():
        raise InputError(f"{path}: no such file")
    try:
        with zipfile.ZipFile(path) as archive:
            header = _read_header(archive, path)
            sizes = _sizes(header)
            arrays = _read_arrays(archive, header, sizes)
    except DAMAGE as error:
        raise FormatError(
            f"{path}: not a whole .mien file ({first_line(error)}); capture the take again"
        ) from error
    try:
        _check(arrays, header)
    except ValueError as error:
        raise FormatError(f"{path}: {error}; capture the take again") from error
    given = {f.name: arrays[f.name] for f in fields(Performance) if f.name in SHAPES}
    return Performance(
        **given,
        points=tuple(header["points"]),
        spans=tuple(Span(**span) for span in header["spans"]),
        scalars={name: arrays[f"scalars/{name}"] for name in header["scalars"]},
        vocabulary=header["vocabulary"],
        source=header["source"],
        faces=header.get("faces", 1),
    )


def _read_header(archive: zipfile.ZipFile, path: Path) -> dict[str, Any]:
    header = read_header(archive, FORMAT, "performance", MAX_HEADER_BYTES)
    version = header.get("version")
    if not isinstance(version, int) or version < 1:
        raise ValueError("its version is no number")
    if version > VERSION:
        raise FormatError(
            f"{path}: version {version} of the performance file, this program reads up to "
            f"{VERSION}; update mien"
        )
    return header


def _sizes(header: dict[str, Any]) -> dict[str, int]:
    """Check the header and give the sizes its arrays must have."""
    for name in ("points", "scalars"):
        _require_names(header[name], name)
    for name in ("vocabulary", "source"):
        if not isinstance(header[name], str) or len(header[name]) > MAX_TEXT:
            raise ValueError(f"'{name}' in its header is not a short text")
    if not isinstance(header["spans"], list) or len(header["spans"]) > MAX_POINTS:
        raise ValueError("'spans' in its header is not a list")
    for span in header["spans"]:
        _require_span(span, header["points"])
    frames = _require_count(header["frames"], MAX_FRAMES, "frames")
    _require_count(header.get("faces", 1), MAX_NAMES, "faces")
    weights = _require_count(header["weights"], MAX_NAMES, "weights")
    spoken = frames if weights else 0
    return {"F": frames, "P": len(header["points"]), "G": spoken, "K": weights}


def _require_names(names: object, what: str) -> None:
    ok = isinstance(names, list) and len(names) <= (MAX_POINTS if what == "points" else MAX_NAMES)
    if ok and isinstance(names, list):
        ok = all(isinstance(n, str) and 0 < len(n) <= 64 for n in names)
        ok = ok and len(set(names)) == len(names)
    if not ok:
        raise ValueError(f"'{what}' in its header is not a list of different short names")


def _require_span(span: object, points: list[str]) -> None:
    ok = isinstance(span, dict) and set(span) == {"first", "second", "axis", "sigma"}
    if ok and isinstance(span, dict):
        ok = (
            span["first"] in points
            and span["second"] in points
            and type(span["axis"]) is int
            and span["axis"] in (0, 1, 2)
            and isinstance(span["sigma"], float | int)
            and isfinite(span["sigma"])
            and span["sigma"] >= 0.0
        )
    if not ok:
        raise ValueError("a span in its header is broken")


def _require_count(value: object, largest: int, what: str) -> int:
    if type(value) is not int or not 0 <= value <= largest:
        raise ValueError(f"'{what}' in its header is not a number from 0 to {largest}")
    return value


def _read_arrays(
    archive: zipfile.ZipFile, header: dict[str, Any], sizes: dict[str, int]
) -> dict[str, NDArray[Any]]:
    """Every array, at exactly the size the header lets expect; nothing larger is unpacked."""
    shapes = {
        name: tuple(size if isinstance(size, int) else sizes[size] for size in shape)
        for name, shape in SHAPES.items()
    }
    shapes |= {f"scalars/{name}": (sizes["F"],) for name in header["scalars"]}
    if 8 * sum(prod(shape) for shape in shapes.values()) > MAX_BYTES:
        raise ValueError(f"its arrays are larger than {MAX_BYTES >> 20} MiB")
    return {
        name: read_array(archive, name, shape, "?" if name == "lost" else "<f8")
        for name, shape in shapes.items()
    }


def _check(arrays: dict[str, NDArray[Any]], header: dict[str, Any]) -> None:
    """Laws every performance obeys."""
    for name, array in arrays.items():
        if not np.isfinite(array).all():
            raise ValueError(f"'{name}' holds numbers that are not finite")
    time = arrays["time"]
    if len(time) and (time[0] < 0.0 or (np.diff(time) <= 0.0).any()):
        raise ValueError("its times do not increase")
    for name in ("rotation", "rest_rotation"):
        r = arrays[name]
        with np.errstate(over="ignore", invalid="ignore"):
            off = np.abs(np.einsum("...ij,...kj->...ik", r, r) - np.eye(3))
        if r.size and not (off.max() < 1e-3 and (np.linalg.det(r) > 0.0).all()):
            raise ValueError(f"'{name}' holds what is no rotation")
    if (arrays["sigma"] < 0.0).any():
        raise ValueError("'sigma' is negative")
    if header["weights"] and not header["vocabulary"]:
        raise ValueError("it holds weights of no vocabulary")
