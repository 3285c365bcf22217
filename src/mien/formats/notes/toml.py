"""Small files that people write by hand, in TOML."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from mien.errors import FormatError, InputError

_LARGEST = 4 << 20


def read_toml(path: Path) -> dict[str, Any]:
    """What a file says. Raises InputError, FormatError."""
    try:
        with path.open("rb") as file:
            text = file.read(_LARGEST + 1)
    except FileNotFoundError as error:
        raise InputError(f"{path}: no such file") from error
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror or error})") from error
    if len(text) > _LARGEST:
        raise FormatError(f"{path}: larger than anybody writes by hand")
    try:
        return tomllib.loads(text.decode("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise FormatError(f"{path}: not TOML ({error})") from error


def number(value: object, least: float, most: float) -> float | None:
    """``value`` where it is a number from ``least`` to ``most``, else None."""
    if type(value) is int or type(value) is float:
        return float(value) if least <= value <= most else None
    return None
