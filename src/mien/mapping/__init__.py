"""Mapping: a performance becomes curves of a character.

A mapper is built once for a character and a performer. To add one, write a module and a line in
MAPPERS.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Protocol

from mien.face.character import Character
from mien.mapping.fap import FapMapper
from mien.mapping.joint import JointMapper
from mien.mapping.population import PopulationMapper
from mien.mapping.settings import Settings
from mien.mapping.wires import WireMapper
from mien.performance.curves import Curves
from mien.performance.performance import Performance

__all__ = ["MAPPERS", "BuildMapper", "FapMapper", "JointMapper", "Mapper", "Settings"]


class Mapper(Protocol):
    """Maps frames of one performer to one character, each frame by itself."""

    def __call__(self, performance: Performance) -> Curves:
        """Curves with as many frames as ``performance``."""


class BuildMapper(Protocol):
    """Builds a mapper for a character and the performer of ``header``."""

    def __call__(self, character: Character, header: Performance, settings: Settings) -> Mapper:
        """Raises InputError where character and performer have too little in common."""


def _bounded(character: Character, header: Performance, settings: Settings) -> JointMapper:
    return JointMapper(character, header, replace(settings, coupling=0.0))


MAPPERS: Mapping[str, BuildMapper] = MappingProxyType(
    {
        "cardinal": JointMapper,
        "bounded": _bounded,
        "fap": FapMapper,
        "genetic": PopulationMapper,
        "wires": WireMapper,
    }
)
"""The first is the default."""
