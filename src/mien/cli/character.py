"""List the characters, or look at one."""

from __future__ import annotations

import argparse
from pathlib import Path

from mien.cli.command import tell
from mien.cli.results import results
from mien.errors import InputError


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "action",
        choices=("list", "show"),
        help="list: what characters there are; show: a sheet with all that one can do",
    )
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help="characters or character files (default: built-in)"
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        default=Path("out/characters"),
        metavar="FOLDER|FILE.png",
        help="show: where NAME.png goes, or a file for one character (default: %(default)s)",
    )


def run(options: argparse.Namespace) -> None:
    if options.action == "list":
        _list(options)
    else:
        _show(options)


def _list(options: argparse.Namespace) -> None:
    from mien.face.library import CHARACTERS, load_character

    characters = [load_character(name) for name in options.names or CHARACTERS]
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
        *(
            f"{character.name}: {len(character.face.triangles)} triangles, "
            f"key models {', '.join(character.keys.names)}"
            for character in characters
        ),
    )


def _show(options: argparse.Namespace) -> None:
    from mien.face.library import CHARACTERS, load_character
    from mien.formats.images import write_image
    from mien.view.contact_sheet import contact_sheet

    characters = [load_character(name) for name in options.names or CHARACTERS]
    folder, names = options.output, [f"{character.name}.png" for character in characters]
    if folder.suffix.lower() == ".png":
        if len(characters) > 1:
            raise InputError(f"-o {folder}: one file for {len(characters)} characters")
        folder, names = folder.parent, [folder.name]
    written = []
    with results(folder) as claim:
        for character, name in zip(characters, names, strict=True):
            written.append(claim(name))
            write_image(written[-1], contact_sheet(character))
    tell(options, {"files": [str(path) for path in written]}, *map(str, written))
