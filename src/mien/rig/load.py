"""Characters by name or from any file that holds one."""

from __future__ import annotations

from pathlib import Path

from mien.face import library
from mien.face.character import Character


def load_character(name_or_path: str | Path) -> Character:
    """A built-in character by name, a character file, or one that is imported as it is read.

    Raises InputError where nothing answers to the name or where something must be asked that
    'mien character import' has options for; FormatError where the file is broken.
    """
    name, path = str(name_or_path), Path(name_or_path)
    if name not in (*library.CHARACTERS, library.GENERIC) and path.exists():
        from mien.rig.importer import import_character, readable

        if readable(path):
            return import_character(path).character
    return library.load_character(name_or_path)
