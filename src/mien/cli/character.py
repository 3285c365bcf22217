"""List the characters, look at one, or take it into another program."""

from __future__ import annotations

import argparse
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

from mien.cli import imported, make, suggest, wires
from mien.cli.command import tell
from mien.cli.results import results
from mien.errors import InputError

if TYPE_CHECKING:
    from mien.face.character import Character

_OUTPUT = Path("out/characters")


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "action",
        choices=("list", "show", "export", "import", "check", "make", "wires", "suggest"),
        help="list: what characters there are, and with a NAME what it can do; "
        "show: a sheet with all of it; "
        "export: a GLB with its key models as morph targets; "
        "import: a character file from a GLB, VRM or folder of OBJ files; "
        "check: what is in such a file, what its shapes do and what looks wrong (-o X.png draws "
        "it); "
        "make: key models for a face that has none; "
        "wires: the control points of its key models, in a file to edit (and --wires FILE to take "
        "it back); "
        "suggest: the key model it lacks most for --takes",
    )
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help="characters or character files (default: built-in)"
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        default=_OUTPUT,
        metavar="FOLDER|FILE",
        help="where NAME.png or NAME.glb goes, or a file for one character (default: %(default)s)",
    )
    parser.add_argument(
        "--shapes",
        choices=make.SETS,
        default=make.SETS[0],
        help="which key models to make (default: %(default)s)",
    )
    parser.add_argument(
        "--points", type=Path, metavar="FILE", help="feature points of a face in another's file"
    )
    parser.add_argument(
        "--units", metavar="UNIT", help="its unit: mm, cm, m ..., or face where size does not count"
    )
    parser.add_argument(
        "--map", type=Path, metavar="FILE", help="what shapes mean, where measuring them fails"
    )

    parser.add_argument("--wires", type=Path, metavar="FILE", help="edited control points")
    parser.add_argument(
        "--takes", nargs="+", metavar="TAKE", help="recordings or .mien files to judge by"
    )


def run(options: argparse.Namespace) -> None:
    output = None if options.output == _OUTPUT else options.output
    if options.action == "list":
        _list(options)
    elif options.action == "import":
        imported.import_file(options, output)
    elif options.action == "check":
        imported.check_file(options, output)
    elif options.action == "show":
        _write(options, ".png", _sheet)
    elif options.action == "make":
        make.make_character(options)
    elif options.action == "wires":
        wires.wire_character(options)
    elif options.action == "suggest":
        suggest.suggest_keys(options)
    else:
        _write(options, ".glb", _model)


def _list(options: argparse.Namespace) -> None:
    from mien.face.library import CHARACTERS
    from mien.rig.load import load_character

    characters = [load_character(name) for name in options.names or CHARACTERS]
    lines = []
    for character in characters:
        triangles, keys = len(character.face.triangles), character.keys.names
        lines.append(f"{character.name}: {triangles} triangles, {len(keys)} key models")
        if options.names:
            lines += textwrap.wrap(
                ", ".join(keys), initial_indent="  ", subsequent_indent="  ", width=98
            )
    tell(
        options,
        {
            "characters": [
                {
                    "name": character.name,
                    "vertices": len(character.face.vertices),
                    "triangles": len(character.face.triangles),
                    "key_models": character.keys.names,
                }
                for character in characters
            ]
        },
        *lines,
    )


def _write(
    options: argparse.Namespace, ending: str, write: Callable[[Path, Character], None]
) -> None:
    from mien.face.library import CHARACTERS
    from mien.rig.load import load_character

    characters = [load_character(name) for name in options.names or CHARACTERS]
    folder, names = options.output, [f"{character.name}{ending}" for character in characters]
    if folder.suffix:
        if folder.suffix.lower() != ending:
            raise InputError(f"-o {folder}: {options.action} writes {ending} files")
        if len(characters) > 1:
            raise InputError(f"-o {folder}: one file for {len(characters)} characters")
        folder, names = folder.parent, [folder.name]
    written = []
    with results(folder) as claim:
        for character, name in zip(characters, names, strict=True):
            written.append(claim(name))
            write(written[-1], character)
    tell(options, {"files": [str(path) for path in written]}, *map(str, written))


def _sheet(path: Path, character: Character) -> None:
    from mien.formats.pictures.images import write_image
    from mien.view.contact_sheet import contact_sheet

    write_image(path, contact_sheet(character))


def _model(path: Path, character: Character) -> None:
    from mien.formats.gltf.glb import write_glb

    write_glb(path, character)
