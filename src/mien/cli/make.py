"""Make key models for a face that has none."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from mien.cli.command import remark, tell
from mien.cli.results import results
from mien.errors import InputError

if TYPE_CHECKING:
    from mien.face.character import Character
    from mien.rig.importer import Import
    from mien.rig.sculpted import Sculpted

_TOLD = 4
"""Parts of a mixture that are told."""
SETS = ("arkit", "mpeg4", "mien")
_ENDINGS = (".npz", ".glb")


def make_character(options: argparse.Namespace) -> None:
    """NEUTRAL, the one name that is given, becomes a character with ``--shapes``."""
    from mien.face.library import load_character
    from mien.rig.sculpted import sculpted
    from mien.sculpt.transfer.make import make
    from mien.sculpt.transfer.shapes import driven, shape_sets, source_of

    if len(options.names) != 1:
        raise InputError("character make: name one neutral face")
    found = _imported(options)
    neutral = load_character(options.names[0]) if found is None else found.character
    output = _output(options, neutral.name)
    if output.suffix.lower() not in _ENDINGS:
        raise InputError(f"-o {output}: make writes {' or '.join(_ENDINGS)} files")
    if output.exists() and Path(options.names[0]).exists() and output.samefile(options.names[0]):
        raise InputError(f"-o {output}: that is the neutral itself; choose another name")
    chosen = shape_sets()[options.shapes]
    kept = sculpted(neutral, chosen.names)
    with results(output.parent) as claim:
        remark(options, f"laying {chosen.source} on {neutral.name}")
        made = make(
            neutral.face, source_of(chosen), chosen.names, output.stem, kept.own, kept.poses
        )
        character = driven(made.character, options.shapes)
        _write(claim(output.name), character, found, kept)
    tell(
        options,
        {
            "file": str(output),
            "name": output.stem,
            "shapes": list(made.character.keys.names),
            "kept": list(kept.own),
            "poses": {
                pose: {name: round(level, 2) for name, level in mixture.items()}
                for pose, mixture in made.mixtures.items()
            },
            "notes": list(made.notes),
        },
        f"{output.stem}: {len(made.character.keys.names)} key models"
        + (f", {len(kept.own)} of them as they were sculpted" if kept.own else ""),
        *(f"  {pose}: taken for {_sum(mixture)}" for pose, mixture in made.mixtures.items()),
        *(f"  note: {note}" for note in made.notes),
        str(output),
    )


def _write(path: Path, character: Character, found: Import | None, kept: Sculpted) -> None:
    """A character file, or a GLB: the neutral's own with morph targets, where it came from one."""
    from mien.face.store import write_character
    from mien.formats.gltf.glb import write_glb
    from mien.rig.sculpted import write_into_its_file

    if path.suffix.lower() == ".npz":
        write_character(path, character)
    elif found is not None and found.character.origin is not None:
        write_into_its_file(path, found, character, kept)
    else:
        write_glb(path, character)


def _sum(mixture: Mapping[str, float]) -> str:
    """The greater parts of a mixture, "0.8 mouthSmileLeft + 0.7 mouthSmileRight"."""
    most = sorted(mixture.items(), key=lambda part: -part[1])[:_TOLD]
    return " + ".join(f"{level:.1f} {name}" for name, level in most)


def _imported(options: argparse.Namespace) -> Import | None:
    """NEUTRAL from somebody's file; None where it is a character of mien's."""
    from mien.rig.importer import import_character, readable

    path = Path(options.names[0])
    if not path.exists() or not readable(path):
        return None
    return import_character(path, points=options.points, units=options.units, meanings=options.map)


def _output(options: argparse.Namespace, name: str) -> Path:
    given: Path = options.output
    return given if given.suffix else given / f"{name}.npz"
