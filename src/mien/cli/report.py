"""Tell the truth about one retargeting: what was expressed, what was not, and what would help."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from mien.cli.animate import add_mapping_options
from mien.cli.capture import TAKES, add_cut_options, performance_of, take_name
from mien.cli.command import remark, tell
from mien.cli.results import results, spare
from mien.errors import InputError

if TYPE_CHECKING:
    from mien.performance.performance import Performance
    from mien.report.tell import Shown


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("take", metavar="TAKE", help=TAKES)
    add_cut_options(parser)
    parser.add_argument(
        "-c",
        "--character",
        required=True,
        metavar="NAME",
        help="a built-in character or a character file",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help="an .html file (default: TAKE_CHARACTER.html in this folder)",
    )
    add_mapping_options(parser)
    parser.add_argument(
        "--pictures",
        type=Path,
        metavar="VIDEO",
        help="the recording a .mien file was captured from, to be shown beside the character",
    )


def run(options: argparse.Namespace) -> None:
    from mien.formats.atomic import whole_file
    from mien.mapping.spoken import understood
    from mien.recipe import animate, moving
    from mien.report.findings import find
    from mien.report.tell import Story
    from mien.report.tell import tell as told
    from mien.rig.load import load_character

    character = load_character(options.character)
    output: Path = options.output or Path(f"{take_name(options.take)}_{character.name}.html")
    if output.suffix.lower() != ".html":
        raise InputError(f"-o {output}: the report is an .html")
    spare(options.take, [output])
    with results(output.parent) as claim:
        performance, _ = performance_of(options)
        curves = animate(
            performance,
            character,
            mapping=options.mapping,
            gain=options.gain,
            brows=options.brows,
            eyes=options.eyes,
            mouth=options.mouth,
            head=options.head,
            own_range=options.own_range,
            smooth=not options.no_filter,
        )
        if not understood(performance, character):
            performance = moving(performance)
        remark(options, "measuring, and drawing pictures")
        findings = find(performance, character, curves)
        page = told(Story(findings, take_name(options.take), _shown(options, performance)))
        with whole_file(claim(output.name)) as temporary:
            temporary.write_text(page, "utf-8")
    tell(
        options,
        {
            "take": options.take,
            "character": character.name,
            "missing": round(findings.reach.missing, 4),
            "unreached_frames": int(findings.reach.unreached.sum()),
            "tremble_mm": round(findings.rest.tremble[1], 4),
            "suggestions": [suggestion.name for suggestion in findings.suggestions],
            "file": str(output),
        },
        f"{options.take}: {findings.reach.missing:.0%} of the motion found no key model of "
        f"{character.name}, {int(findings.reach.unreached.sum())} frames are not reached",
        str(output),
    )


def _shown(options: argparse.Namespace, performance: Performance) -> Shown:
    """What shows pictures of the take, where there are any."""
    from mien.report.pictures import has_pictures, of_take

    take = str(options.pictures or options.take)
    if not has_pictures(take):
        return lambda frames, side: []
    return lambda frames, side: of_take(
        take,
        performance,
        frames,
        side,
        start=options.start,
        mirror=options.mirror,
        rate=options.rate,
        focal=options.focal if isinstance(options.focal, float) else None,
    )
