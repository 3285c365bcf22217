"""Curves into a file whose ending names its kind. To add a kind, write a module and one line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from mien.errors import InputError
from mien.face.character import Character
from mien.formats.glb import write_glb
from mien.formats.table import write_table
from mien.performance.curves import Curves

Saver = Callable[[Path, Character, Curves], None]

SAVERS: dict[str, Saver] = {
    ".glb": write_glb,
    ".csv": lambda path, character, curves: write_table(path, curves),
}


def saver(path: Path) -> Saver:
    """The one for the ending of ``path``, the longest that fits. Raises InputError."""
    for ending in sorted(SAVERS, key=len, reverse=True):
        if path.name.lower().endswith(ending):
            return SAVERS[ending]
    raise InputError(
        f"{path}: cannot write files of that ending; there are {', '.join(sorted(SAVERS))}"
    )


def save(curves: Curves, path: str | Path, character: Character) -> None:
    """Write what ``character`` does; the ending of ``path`` chooses the format.

    Raises InputError for an unknown ending, OutputError where it cannot be written.
    """
    saver(Path(path))(Path(path), character, curves)
