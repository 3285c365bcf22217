"""List the characters, or look at one."""

from __future__ import annotations

import argparse

from mien.cli.command import tell


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("action", choices=("list",), help="list: what there is and what it can do")


def run(options: argparse.Namespace) -> None:
    from mien.face.library import CHARACTERS, load_character

    characters = [load_character(name) for name in CHARACTERS]
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
