"""What 'mien character import' and 'check' do: read somebody's character, and tell of it."""

from __future__ import annotations

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mien.cli.command import tell
from mien.cli.results import results
from mien.errors import InputError, MissingExtraError, NoFaceError

if TYPE_CHECKING:
    from mien.face.model import Model
    from mien.rig.importer import Import

ENDING = ".character"


def import_file(options: argparse.Namespace, output: Path | None) -> None:
    """Make a character file of one that is somebody's."""
    from mien.face.store import write_character
    from mien.rig.importer import import_character

    source = _one(options)
    output = _output(output, source)
    name = output.name.removesuffix(output.suffix)
    found = import_character(
        source, points=options.points, units=options.units, meanings=options.map, name=name
    )
    with results(output.parent) as claim:
        write_character(claim(output.name), found.character)
    tell(
        options,
        {"source": str(source), "file": str(output), **describe(found)},
        f"{source}: {len(found.character.examples)} of {len(found.acts)} shapes act",
        *(f"  note: {note}" for note in found.notes),
        str(output),
    )


def check_file(options: argparse.Namespace, picture: Path | None) -> None:
    """Tell what is in a character's file, what each shape does, and what looks wrong; draw it with
    its feature points into ``picture``."""
    from mien.rig.doubts import doubts
    from mien.rig.importer import read_model

    source = _one(options)
    model = read_model(source)
    facts: dict[str, Any] = {"file": str(source), **measures(model)}
    lines = [
        f"{source}: {facts['vertices']} vertices, {facts['triangles']} triangles, "
        f"{len(model.shapes)} shapes"
    ]
    reached = _reached(options, source)
    if reached.found is None:
        facts |= {"notes": list(model.notes), "face": None, "doubts": [reached.reason]}
    else:
        facts |= describe(reached.found)
        facts["doubts"] = doubts(reached.found, model)
        lines += _table(reached.found)
    if facts.get("unexpressed"):
        lines.append(f"  no shape expresses: {', '.join(facts['unexpressed'])}")
    lines += [f"  note: {note}" for note in facts["notes"]]
    lines += [f"  doubt: {doubt}" for doubt in facts["doubts"]]
    if reached.found is not None and picture is not None:
        facts["files"] = [str(_draw(picture, reached.found))]
        lines += facts["files"]
    tell(options, facts, *lines)


@dataclass(frozen=True, slots=True)
class _Reached:
    """A character, or the reason why a sound file did not become one."""

    found: Import | None
    reason: str = ""


def _reached(options: argparse.Namespace, source: Path) -> _Reached:
    from mien.rig.importer import ANY_SIZE, import_character

    try:
        found = import_character(
            source,
            points=options.points,
            units=options.units or ANY_SIZE,
            meanings=options.map,
        )
    except (NoFaceError, MissingExtraError) as error:
        return _Reached(None, str(error))
    return _Reached(found)


def measures(model: Model) -> dict[str, Any]:
    """Size and place of a model, in its own unit and axes."""
    vertices = model.vertices
    return {
        "vertices": len(vertices),
        "triangles": len(model.triangles),
        "low": [round(float(x), 6) for x in vertices.min(axis=0)],
        "high": [round(float(x), 6) for x in vertices.max(axis=0)],
        "parts": [part.name for part in model.parts],
        "shape_names": [shape.name for shape in model.shapes],
        "vrm": model.hooks.vrm,
        "head_node": model.hooks.head,
        "eye_nodes": list(model.hooks.eyes),
    }


def describe(found: Import) -> dict[str, Any]:
    """What an import found, for --json."""
    from mien.rig.acts import unexpressed
    from mien.rig.spoken import vocabulary_of

    character = found.character
    return {
        "face": {
            "points": list(character.face.points.ids),
            "facing": "+z" if found.facing > 0 else "-z",
        },
        "vocabulary": vocabulary_of(found.acts),
        "acts": len(character.examples),
        "blinks": sorted(character.blinks),
        "shapes": [
            {
                "name": act.name,
                "region": act.region,
                "side": act.side,
                "confidence": round(act.confidence, 3),
                "left": round(act.left, 3),
                "like": act.like,
                "likeness": round(act.likeness, 3),
                "size_mm": round(act.size, 2),
                "shuts": [round(part, 3) for part in act.shuts],
                "acts": act.name in character.examples,
            }
            for act in sorted(found.acts, key=lambda act: act.name)
        ],
        "unexpressed": list(unexpressed(character)),
        "notes": list(found.notes),
    }


def _table(found: Import) -> list[str]:
    return [
        f"  {act.name[:28]:28s} {act.region or '-':6s} {act.side:6s} {act.confidence:4.2f}  "
        f"like {act.like} {act.likeness:.2f}"
        for act in sorted(found.acts, key=lambda act: act.name)
    ]


def _draw(path: Path, found: Import) -> Path:
    from mien.formats.pictures.images import write_image
    from mien.view.points_sheet import points_sheet

    write_image(path, points_sheet(found.character))
    return path


def _one(options: argparse.Namespace) -> Path:
    if len(options.names) != 1:
        raise InputError(f"character {options.action}: name one file or folder")
    return Path(options.names[0])


def _output(given: Path | None, source: Path) -> Path:
    """Where the character file goes: -o NAME or a folder, else into this one."""
    stem = source.resolve().name if source.is_dir() else source.stem
    if given is None:
        return Path(f"{stem}{ENDING}")
    if given.suffix == ENDING:
        return given
    if given.suffix:
        raise InputError(f"-o {given}: import writes {ENDING} files")
    # A character's own folder is no place for results: -o fox beside fox/ is a name.
    into = given.is_dir() and given.resolve() != source.resolve()
    return given / f"{stem}{ENDING}" if into else Path(f"{given}{ENDING}")
