"""The faces that come with mien: the generic face and the four characters."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from mien.errors import InputError
from mien.face.character import Character
from mien.face.store import read_character

CHARACTERS = ("man", "woman", "monkey", "toy")
GENERIC = "generic"

_DATA = Path(__file__).parent / "data"


def character_file(name: str) -> Path:
    """Where the built-in face ``name`` ("generic" or one of CHARACTERS) is kept."""
    return _DATA / f"{name}.npz"


def load_character(name_or_path: str | Path) -> Character:
    """A built-in character by name, or any character from a file.

    Raises InputError where nothing answers to the name, FormatError where the file is broken.
    """
    name = str(name_or_path)
    if name in (*CHARACTERS, GENERIC):
        return read_character(character_file(name))
    if not Path(name).exists():
        raise InputError(
            f"{name}: no such character; there are {', '.join(CHARACTERS)}, "
            "or name a file (.character)"
        )
    return read_character(name)


@cache
def generic_face() -> Character:
    """The generic face. Its skin's vertices 0 to 467 are the detector's landmarks. Shared: do
    not write into its arrays."""
    return load_character(GENERIC)
