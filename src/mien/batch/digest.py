"""Names made of content: the same bytes and the same wishes give the same name, on any machine."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from mien.errors import InputError


def digest_of(path: str | Path) -> str:
    """SHA-256 of a file, or of the names and contents of a folder's files. Raises InputError where
    there is nothing to read."""
    path = Path(path)
    if not path.exists():
        raise InputError(f"{path}: no such file")
    try:
        if not path.is_dir():
            return _of_file(path)
        files = sorted(file for file in path.rglob("*") if file.is_file())
        return digest_of_facts(
            {file.relative_to(path).as_posix(): _of_file(file) for file in files}
        )
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({(error.strerror or '').lower()})") from error


def digest_of_facts(facts: Mapping[str, Any]) -> str:
    """SHA-256 of what JSON can say, in whatever order it was said."""
    return hashlib.sha256(json.dumps(facts, sort_keys=True).encode()).hexdigest()


def _of_file(path: Path) -> str:
    with path.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()
