"""Let a recorded face drive characters: GLB files with animation, and a preview."""

from __future__ import annotations

import argparse
import os
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from mien.cli.capture import (
    TAKES,
    add_cut_options,
    describe,
    performance_of,
    summarize,
    take_name,
)
from mien.cli.cast import cast_of
from mien.cli.command import not_negative, positive, remark, tell
from mien.cli.progress import progress
from mien.cli.results import results, spare
from mien.errors import InputError

if TYPE_CHECKING:
    from mien.face.character import Character
    from mien.performance.curves import Curves

PREVIEW = "preview.mp4"


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("take", metavar="TAKE", help=TAKES)
    add_cut_options(parser)
    add_acting_options(parser, None)


def add_acting_options(parser: argparse.ArgumentParser, output: str | None) -> None:
    """Who acts, how, and where the results go (``output`` when nothing is said)."""
    parser.add_argument(
        "-o",
        "--output",
        default=output,
        metavar="FOLDER|FILE",
        help="a folder, or a file whose ending chooses the format where there is one result "
        f"(default: {output or 'out/TAKE'})",
    )
    add_cast_options(parser)
    parser.add_argument(
        "--mapping",
        metavar="NAME",
        help="how motion becomes weights (default: cardinal, or bounded with a databank)",
    )
    parser.add_argument(
        "--databank",
        metavar="FILE|FOLDER",
        help="scanned faces of one person: the surface they show lands on that person, with -c "
        "PERFORMER.obj on the performer's own neutral of the same mesh, and tells -c NAME what no "
        "marker shows",
    )
    add_gain_options(parser)
    parser.add_argument(
        "--own",
        type=Path,
        metavar="FILE",
        help="moments of the take that stand for poses of the character: [[example]] with "
        "seconds = 3.2 and pose = { smile = 1.0 }; or a .performer with faces that were held",
    )
    parser.add_argument(
        "--no-head", action="store_true", help="the head turns but does not leave its place"
    )
    parser.add_argument(
        "--filter",
        choices=("offline", "live"),
        default="offline",
        help="how the detector's tremble goes: looking ahead too, without lag (default: offline), "
        "or as live, from what came before alone",
    )
    parser.add_argument("--no-filter", action="store_true", help="leave the detector's tremble in")
    parser.add_argument("--no-preview", action="store_true", help="write no preview.mp4")


def add_cast_options(parser: argparse.ArgumentParser) -> None:
    """Who acts, and what is written of it."""
    parser.add_argument(
        "-c",
        "--character",
        action="append",
        metavar="NAME",
        dest="characters",
        help="a built-in character or a character file; may be repeated (default: all built-in)",
    )
    parser.add_argument(
        "-f",
        "--format",
        action="append",
        metavar="ENDING",
        dest="formats",
        help="what to write for each character: glb, csv or obj; may be repeated (default: glb)",
    )


def add_mapping_options(parser: argparse.ArgumentParser) -> None:
    """How motion becomes weights, where no databank can be meant."""
    parser.add_argument(
        "--mapping",
        metavar="NAME",
        default="cardinal",
        help="how motion becomes weights (default: %(default)s)",
    )
    add_gain_options(parser)
    parser.add_argument("--no-filter", action="store_true", help="leave the detector's tremble in")


def add_gain_options(parser: argparse.ArgumentParser) -> None:
    """How strongly is acted."""
    parser.add_argument(
        "--gain", type=positive, default=1.0, help="exaggerate (default: 1, as it was)"
    )
    for part in ("brows", "eyes", "mouth", "head"):
        parser.add_argument(
            f"--{part}",
            type=not_negative,
            default=1.0,
            metavar="GAIN",
            help=f"exaggerate the {part} alone (default: 1)",
        )
    parser.add_argument(
        "--own-range",
        action="store_true",
        help="make the range the performer shows in the take the character's",
    )


def run(options: argparse.Namespace) -> None:
    from mien.formats.save import place, save

    cast = cast_of(options)
    plan = _plan(options, [actor.name for actor in cast])
    names = [file for files in plan.files for file in files] + [plan.preview or "."]
    spare(options.take, (plan.folder / name for name in names))
    with results(plan.folder) as claim:
        performance, account = performance_of(options)
        acts: list[tuple[Character, Curves]] = []
        written: list[Path] = []
        for actor, files in zip(cast, plan.files, strict=True):
            remark(options, f"{actor.name} acts")
            character, curves = actor.act(performance)
            acts.append((character, curves))
            for file in (*files, *_besides(options, files, character)):
                claim(place(Path(file)).name)
                written.append(save(curves, plan.folder / file, character))
        if plan.preview:
            written.append(claim(plan.preview))
            _film(options, acts, written[-1])
    summary = summarize(performance) | account
    tell(
        options,
        {
            "take": options.take,
            **summary,
            "characters": [_account(character, curves) for character, curves in acts],
            "files": [str(path) for path in written],
        },
        f"{options.take}: {describe(summary)}",
        *map(str, written),
    )


@dataclass(frozen=True, slots=True)
class Plan:
    """Which files are to be written."""

    folder: Path
    files: tuple[tuple[str, ...], ...]
    """Names in ``folder`` for each character."""
    preview: str | None


def _plan(options: argparse.Namespace, names: list[str]) -> Plan:
    from mien.formats.save import place

    twice = {name for name in names if names.count(name) > 1}
    if twice:
        raise InputError(f"-c {min(twice)}: named twice; each character is written once")
    given: str | None = options.output
    output = Path("out", take_name(options.take)) if given is None else Path(given)
    if given is None or given.endswith(("/", os.sep)) or output.is_dir() or not output.suffix:
        endings = dict.fromkeys(e.lstrip(".").lower() for e in options.formats or ["glb"])
        files = tuple(tuple(f"{name}.{ending}" for ending in endings) for name in names)
        for file in files[0]:
            place(Path(file))
        return Plan(output, files, None if options.no_preview else PREVIEW)
    if options.formats:
        raise InputError(f"-f {options.formats[0]}: only with a folder; -o {given} names a file")
    if output.suffix.lower() == ".mp4":
        return Plan(output.parent, ((),) * len(names), output.name)
    place(output)
    if len(names) > 1:
        raise InputError(
            f"-o {given}: one file for {len(names)} characters; choose one with -c, "
            "or name a folder"
        )
    return Plan(output.parent, ((output.name,),), None)


def _besides(
    options: argparse.Namespace, files: tuple[str, ...], character: Character
) -> tuple[str, ...]:
    """A VRM character also gets a VRM animation where nobody chose formats or one file."""
    vrm = character.origin is not None and character.origin.hooks.vrm is not None
    if not vrm or options.formats or files != (f"{character.name}.glb",):
        return ()
    return (f"{character.name}.vrma",)


def _film(options: argparse.Namespace, acts: list[tuple[Character, Curves]], path: Path) -> None:
    from mien.formats.markers.file import holds_markers
    from mien.recipe import READERS, film

    no_pictures = Path(options.take).suffix.lower() in READERS or holds_markers(options.take)
    with progress("drawing the preview") as told:
        film(
            acts,
            path,
            take=None if no_pictures else options.take,
            start=options.start,
            end=options.end,
            mirror=options.mirror,
            rate=options.rate,
            progress=told,
        )


def _account(character: Character, curves: Curves) -> dict[str, object]:
    """What a machine may want to know of one character's act."""
    rms = float((curves.residual**2).mean() ** 0.5)
    return {
        "name": character.name,
        "morph_targets": len(curves.names),
        "residual_mm": round(rms, 4),
        "largest_weight": round(float(abs(curves.weights).max(initial=0.0)), 4),
    }
