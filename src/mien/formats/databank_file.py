"""Databanks as files: a character's file (``face.store``) whose examples are all its faces."""

from __future__ import annotations

from pathlib import Path

from mien.errors import FormatError
from mien.face.databank import Databank, databank
from mien.face.store import read_character, write_character


def write_databank(path: Path | str, bank: Databank) -> None:
    """Write ``bank`` to ``path`` (.npz), to a thousandth of a millimetre. Raises OutputError."""
    write_character(path, bank.character())


def read_databank(path: Path | str) -> Databank:
    """Read a databank; a character's file is one of its examples.

    Raises InputError where there is no file, FormatError where it is broken or has no faces.
    """
    character = read_character(path)
    if not character.examples:
        raise FormatError(f"{path}: holds a neutral but no faces; build it with 'mien databank'")
    return databank(character)
