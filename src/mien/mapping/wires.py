"""Mapping to wires [B] §2: each key model is blended wire by wire, so that one part of a face shows
what another does not: the upper face of one example with the mouth of another, half a smile."""

from __future__ import annotations

from dataclasses import replace

from mien.errors import InputError
from mien.face.character import Character
from mien.face.wires import wire_pieces
from mien.mapping.joint import JointMapper
from mien.mapping.settings import Settings
from mien.performance.performance import Performance

_LOOSE = 0.1
"""Part of the usual pull of a key model's pieces to each other: they are to differ."""


class WireMapper(JointMapper):
    """One character, driven by its wires. Raises InputError as JointMapper, and where the face has
    no feature points to run wires through."""

    def __init__(
        self, character: Character, header: Performance, settings: Settings | None = None
    ) -> None:
        given = settings or Settings()
        loose = replace(given, balance=_LOOSE * given.balance, kinship=_LOOSE * given.kinship)
        try:
            pieces = wire_pieces(character)
        except ValueError as error:
            raise InputError(f"{character.name}: --mapping wires: {error}") from error
        super().__init__(character, header, loose, pieces)
