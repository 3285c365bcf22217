"""Curves into a file whose ending names its kind. To add a kind, write a module and one line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from mien.errors import InputError
from mien.face.character import Character
from mien.performance.curves import Curves

# Each is imported when it is used: ``mien --help`` does not wait for them.
Saver = Callable[[Path, Character, Curves], None]


def _glb(path: Path, character: Character, curves: Curves) -> None:
    from mien.formats.glb import write_glb

    write_glb(path, character, curves)


def _table(path: Path, character: Character, curves: Curves) -> None:
    from mien.formats.table import write_table

    write_table(path, curves)


SAVERS: dict[str, Saver] = {
    ".glb": _glb,
    ".csv": _table,
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
