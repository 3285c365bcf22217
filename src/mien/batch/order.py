"""What is wanted of every take, and the names of what comes of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from importlib import metadata
from pathlib import Path
from typing import Any

from mien.batch.digest import digest_of, digest_of_facts
from mien.errors import InputError
from mien.face.library import CHARACTERS, GENERIC, character_file
from mien.formats.save import place
from mien.rig.load import load_character


def version() -> str:
    """Of the mien that runs here."""
    return metadata.version("mien")


@dataclass(frozen=True, slots=True)
class Role:
    """A character, as it is asked for."""

    name: str
    source: str
    """A built-in character's name, or the absolute path of a file."""
    digest: str


@dataclass(frozen=True, slots=True)
class Order:
    """What is wanted of every take, alike for all."""

    roles: tuple[Role, ...]
    formats: tuple[str, ...] = ("glb",)
    """Endings of ``mien.formats.save``."""
    looking: Mapping[str, Any] = field(default_factory=dict)
    """Options of ``recipe.capture`` for what has to be captured."""
    markers: Mapping[str, Any] = field(default_factory=dict)
    """Options of ``recipe.capture_markers`` for what holds markers."""
    acting: Mapping[str, Any] = field(default_factory=dict)
    """Options of ``recipe.animate``."""
    version: str = field(default_factory=version)

    def capture_key(self, take: str) -> str:
        """The name of what is captured of a take, of which ``take`` is the digest."""
        return digest_of_facts(
            {
                "mien": self.version,
                "take": take,
                "looking": _read(self.looking),
                "markers": _read(self.markers),
            }
        )

    def result_key(self, capture_key: str, role: Role) -> str:
        """The name of what a character makes of a capture."""
        return digest_of_facts(
            {
                "capture": capture_key,
                "role": [role.name, role.digest],
                "formats": self.formats,
                "acting": _read(self.acting),
            }
        )

    def result_keys(self, take: str) -> list[str]:
        """The names of all results of a take, character for character."""
        capture_key = self.capture_key(take)
        return [self.result_key(capture_key, role) for role in self.roles]


def roles(names: Sequence[str]) -> tuple[Role, ...]:
    """The characters called ``names``: built-in ones and files. Raises InputError, FormatError
    where one cannot be used."""
    found = []
    for name in names or CHARACTERS:
        character = load_character(name)
        built_in = name in (*CHARACTERS, GENERIC)
        file = character_file(name) if built_in else Path(name).resolve()
        source = name if built_in else str(file)
        found.append(Role(character.name, source, digest_of(file)))
    called = [role.name for role in found]
    twice = {name for name in called if called.count(name) > 1}
    if twice:
        raise InputError(f"-c {min(twice)}: named twice; each character acts once")
    return tuple(found)


def formats(endings: Sequence[str] | None) -> tuple[str, ...]:
    """``endings`` as an order has them. Raises InputError for one that cannot be written."""
    wanted = tuple(dict.fromkeys(ending.lstrip(".").lower() for ending in endings or ["glb"]))
    for ending in wanted:
        place(Path(f"x.{ending}"))
    return wanted


def _read(options: Mapping[str, Any]) -> dict[str, Any]:
    """Options with the content of the files they name in place of their paths."""
    return {
        name: digest_of(value) if isinstance(value, Path) else value
        for name, value in options.items()
    }
