"""The troupe: the characters a page may put on stage, those of mien and those that were brought."""

from __future__ import annotations

import tempfile
from functools import lru_cache
from pathlib import Path
from urllib.parse import quote

from mien.errors import InputError
from mien.face import library
from mien.face.character import Character
from mien.face.pieces import split
from mien.formats.gltf.glb import write_glb
from mien.live.studio.shelf import CHARACTERS, Shelf
from mien.mapping.beside import driven_beside

_KEPT = 8
"""Characters that are kept in memory."""


class Troupe:
    """Characters by name; what is returned is shared, so do not write into it."""

    def __init__(self, shelf: Shelf) -> None:
        self._shelf = shelf

    def names(self) -> list[str]:
        """Everybody."""
        brought = [Path(name).stem for name in self._shelf.names(CHARACTERS)]
        return [*library.CHARACTERS, *brought]

    def character(self, name: str) -> Character:
        """A character. Raises InputError where there is none of that name, FormatError."""
        return _loaded(*self._where(name))

    def address(self, name: str) -> str:
        """Where a page finds ``still``; another one once the character has changed."""
        return f"characters/{quote(name)}.glb?of={self._where(name)[1]:.3f}"

    def still(self, name: str) -> bytes:
        """A character's GLB, whose morph targets are what its weights move. Raises as
        ``character``."""
        return _still(*self._where(name))

    def _where(self, name: str) -> tuple[str, float]:
        """A name or file that can be loaded, and when it changed."""
        if name in library.CHARACTERS:
            return name, 0.0
        try:
            path = self._shelf.there(f"{name}.character", CHARACTERS)
        except InputError as error:
            raise InputError(f"{name[:60]}: nobody in the troupe has that name") from error
        return str(path), path.stat().st_mtime


def targets(character: Character) -> tuple[str, ...]:
    """What a character's weights move, in the order in which a page is told them."""
    return tuple(dict.fromkeys((*split(character).names, *driven_beside(character))))


@lru_cache(maxsize=_KEPT)
def _loaded(name_or_path: str, changed: float) -> Character:
    return library.load_character(name_or_path)


@lru_cache(maxsize=_KEPT)
def _still(name_or_path: str, changed: float) -> bytes:
    character = _loaded(name_or_path, changed)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.glb"
        write_glb(path, character, names=targets(character))
        return path.read_bytes()
