"""Write the wires of a character's key models, or take edited ones back."""

from __future__ import annotations

import argparse
from pathlib import Path

from mien.cli.command import tell
from mien.cli.results import results
from mien.errors import InputError


def wire_character(options: argparse.Namespace) -> None:
    """NAME's wires into a .toml file; with ``--wires FILE``, NAME with its control points moved as
    the file says into a .npz file."""
    from mien.face.store import write_character
    from mien.face.wires import control_motion, with_moved_wires
    from mien.formats.notes.wires import read_wires, write_wires
    from mien.rig.load import load_character

    if len(options.names) != 1:
        raise InputError("character wires: name one character")
    character = load_character(options.names[0])
    ending = ".toml" if options.wires is None else ".npz"
    output = _output(options, f"{character.name}_wires{ending}", ending)
    try:
        wired = {key: control_motion(character, key) for key in character.examples}
    except ValueError as error:
        raise InputError(f"{character.name}: {error}") from error
    edited = {} if options.wires is None else read_wires(options.wires)
    for key, points in edited.items():
        if key not in character.keys.names:
            raise InputError(f"{options.wires}: {character.name} has no key model '{key[:40]}'")
        unknown = set(points) - set(control_motion(character, key))
        if unknown:
            raise InputError(f"{options.wires}: [{key}] no wire has a point '{min(unknown)[:20]}'")
        character = with_moved_wires(character, key, points)
    with results(output.parent) as claim:
        path = claim(output.name)
        if options.wires is None:
            write_wires(path, wired)
        else:
            write_character(path, character)
    tell(
        options,
        {"file": str(output), "character": character.name, "edited": list(edited)},
        str(output),
    )


def _output(options: argparse.Namespace, name: str, ending: str) -> Path:
    given: Path = options.output
    if not given.suffix:
        return given / name
    if given.suffix.lower() != ending:
        raise InputError(f"-o {given}: wires writes {ending} files here")
    return given
