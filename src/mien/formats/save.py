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
    if character.origin is not None:
        from mien.formats.gltf.animated import write_animated

        write_animated(path, character, curves)
        return
    from mien.formats.gltf.glb import write_glb

    write_glb(path, character, curves)


def _table(path: Path, character: Character, curves: Curves) -> None:
    from mien.formats.takes.table import write_table

    write_table(path, curves)


def _obj(path: Path, character: Character, curves: Curves) -> None:
    from mien.formats.meshes.obj import write_obj_sequence

    write_obj_sequence(path, character, curves)


def _vrma(path: Path, character: Character, curves: Curves) -> None:
    from mien.formats.gltf.vrma import write_vrma

    write_vrma(path, character, curves)


SAVERS: dict[str, Saver] = {
    ".glb": _glb,
    ".csv": _table,
    ".obj": _obj,
    ".vrma": _vrma,
}
FOLDERS = frozenset({".obj"})
"""Kinds that are a folder of files: it is called as the file would be, without the ending."""


def place(path: Path) -> Path:
    """Where ``save`` puts what is called ``path``. Raises InputError for an unknown ending."""
    if path.suffix.lower() not in SAVERS:
        raise InputError(
            f"{path}: cannot write files of that ending; there are {', '.join(sorted(SAVERS))}, "
            "and .mp4 for a film"
        )
    return path.with_suffix("") if path.suffix.lower() in FOLDERS else path


def save(curves: Curves, path: str | Path, character: Character) -> Path:
    """Write what ``character`` does; the ending of ``path`` chooses the format: .glb (morph
    targets and animation), .csv (a table of weights), .obj (a folder with one mesh a frame).

    Returns what was written. Raises InputError for an unknown ending, OutputError where it cannot
    be written.
    """
    written = place(Path(path))
    SAVERS[Path(path).suffix.lower()](written, character, curves)
    return written
