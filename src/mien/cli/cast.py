"""Who acts: characters driven by the motion of feature points, or dense surfaces by a databank."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mien.face.character import Character
    from mien.face.databank import Databank
    from mien.performance.curves import Curves
    from mien.performance.performance import Performance

Act = Callable[["Performance"], tuple["Character", "Curves"]]


@dataclass(frozen=True, slots=True)
class Actor:
    """Somebody who can act a performance."""

    name: str
    act: Act


def cast_of(options: argparse.Namespace) -> list[Actor]:
    """The actors the options name. Raises InputError, FormatError."""
    from mien.face.library import CHARACTERS
    from mien.rig.load import load_character

    if options.databank:
        return _databank_cast(options)
    characters = [load_character(name) for name in options.characters or CHARACTERS]
    return [Actor(character.name, _points(options, character)) for character in characters]


def _databank_cast(options: argparse.Namespace) -> list[Actor]:
    from mien.recipe import load_databank
    from mien.rig.load import load_character

    bank = load_databank(options.databank)
    if not options.characters:
        return [Actor(bank.name, _surface(options, bank, None))]
    actors = []
    for name in options.characters:
        if Path(name).suffix.lower() == ".obj":
            actors.append(Actor(Path(name).stem, _surface(options, bank, name)))
        else:
            character = load_character(name)
            actors.append(Actor(character.name, _points(options, character, bank)))
    return actors


def _surface(options: argparse.Namespace, bank: Databank, performer: str | None) -> Act:
    from mien.recipe import animate_surface, load_performer

    face = None if performer is None else load_performer(performer, bank)
    name = bank.name if performer is None else Path(performer).stem

    def act(performance: Performance) -> tuple[Character, Curves]:
        character, curves = animate_surface(
            performance,
            bank,
            face,
            mapping=options.mapping or "bounded",
            smooth=not options.no_filter,
        )
        return replace(character, name=name), replace(_still(options, curves), character=name)

    return act


def _points(options: argparse.Namespace, character: Character, bank: Databank | None = None) -> Act:
    from mien.recipe import animate, enrich

    def act(performance: Performance) -> tuple[Character, Curves]:
        mapping, smooth = options.mapping, not options.no_filter
        if bank is not None:
            performance = enrich(performance, bank, mapping=mapping or "bounded", smooth=smooth)
            mapping = None
        curves = animate(
            performance,
            character,
            mapping=mapping or "cardinal",
            gain=options.gain,
            brows=options.brows,
            eyes=options.eyes,
            mouth=options.mouth,
            head=options.head,
            own=options.own,
            own_range=options.own_range,
            smooth=smooth,
            causal=options.filter == "live",
        )
        return character, _still(options, curves)

    return act


def _still(options: argparse.Namespace, curves: Curves) -> Curves:
    """``curves`` of a head that stays in its place, where that is asked for."""
    return replace(curves, translation=curves.translation * 0.0) if options.no_head else curves
