"""Suggest which key model to sculpt next, and show it on the character."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from mien.cli.command import remark, tell
from mien.cli.results import results
from mien.errors import InputError

if TYPE_CHECKING:
    from mien.performance.performance import Performance

COUNT = 3
"""How many are suggested."""


def suggest_keys(options: argparse.Namespace) -> None:
    """Name what CHARACTER lacks most for ``--takes``, with a picture of each."""
    from mien.face.library import generic_face
    from mien.formats.pictures.images import write_image
    from mien.mapping.suggest import lacking, suggest
    from mien.rig.load import load_character
    from mien.sculpt.transfer.make import make
    from mien.view.contact_sheet import contact_sheet

    if len(options.names) != 1:
        raise InputError("character suggest: name one character")
    if not options.takes:
        raise InputError("character suggest: name recordings or .mien files with --takes")
    character = load_character(options.names[0])
    generic = generic_face()
    names = lacking(character, generic)
    takes = [_take(take) for take in options.takes]
    remark(options, f"{len(names)} key models are tried")
    found = suggest(character, takes, generic, names, COUNT)
    with results(options.output) as claim:
        wanted = [suggestion.name for suggestion in found]
        made = make(character.face, generic, wanted, character.name)
        picture = claim(f"{character.name}_suggested.png")
        write_image(picture, contact_sheet(made.character))
    tell(
        options,
        {
            "character": character.name,
            "suggestions": [
                {"name": s.name, "before": round(s.before, 4), "after": round(s.after, 4)}
                for s in found
            ],
            "file": str(picture),
        },
        *(
            f"{s.name}: what is not expressed of these takes falls from {s.before:.1%} "
            f"to {s.after:.1%}"
            for s in found
        ),
        str(picture),
    )


def _take(path: str) -> Performance:
    from pathlib import Path

    from mien.recipe import READERS, capture, load_performance

    if Path(path).suffix.lower() in READERS:
        return load_performance(path)
    return capture(path)
