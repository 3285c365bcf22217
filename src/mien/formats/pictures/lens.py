"""A camera's focal length from a small file, for takes of a camera that was measured."""

from __future__ import annotations

import json
import math
import tomllib
from pathlib import Path

from mien.errors import FormatError, InputError

_LARGEST_FILE = 1 << 16
_LARGEST = 1e6
"""Pixels; beyond it, a focal length is a mistake."""


def read_focal(path: Path) -> tuple[float, float | None]:
    """Focal length in pixels, and the width of the pictures it was measured on (None: not said).

    ``path`` is TOML or JSON with ``focal``, or with OpenCV's ``camera_matrix`` (3, 3), whose
    first entry it is; and ``width``. Raises InputError, FormatError.
    """
    if not path.is_file():
        raise InputError(f"--focal {path}: neither a number of pixels nor a camera file")
    if path.stat().st_size > _LARGEST_FILE:
        raise FormatError(f"{path}: too large for a camera file")
    try:
        text = path.read_text(encoding="utf-8")
        known = json.loads(text) if path.suffix.lower() == ".json" else tomllib.loads(text)
        focal = known["focal"] if "focal" in known else known["camera_matrix"][0][0]
        return _pixels(path, focal), _pixels(path, known["width"]) if "width" in known else None
    except (ValueError, KeyError, IndexError, TypeError, RecursionError) as error:
        raise FormatError(
            f"{path}: not a camera file; it should say focal = PIXELS and width = PIXELS"
        ) from error


def _pixels(path: Path, value: object) -> float:
    if not isinstance(value, int | float) or not math.isfinite(value) or not 1 < value < _LARGEST:
        raise FormatError(f"{path}: {value!r} is not a number of pixels")
    return float(value)
