"""Learn a performer from takes: the face at rest, lids, colours, key poses; one file a person."""

from __future__ import annotations

import argparse
from pathlib import Path

from mien.cli.capture import focal
from mien.cli.command import span, tell
from mien.cli.progress import progress
from mien.cli.results import results, spare
from mien.errors import InputError

ENDING = ".performer"


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "takes",
        nargs="+",
        metavar="TAKE",
        help="videos or folders of images of one person; seconds count through all of them",
    )
    parser.add_argument(
        "-o", "--output", type=Path, required=True, metavar="FILE", help=f"a {ENDING} file"
    )
    parser.add_argument(
        "--neutral",
        type=span,
        metavar="SECONDS",
        help="when the face rests: 2.5, or 2.5-3 (default: found)",
    )
    parser.add_argument(
        "--shut",
        type=span,
        metavar="SECONDS",
        help="when both eyes are shut, such as 3-3.4; glasses change how shut eyes look "
        "(default: when they are narrowest)",
    )
    parser.add_argument(
        "--pose",
        action="append",
        default=[],
        type=pose,
        metavar="NAME=SECONDS",
        help="when a key pose is held, such as smile=4-4.5; may be repeated",
    )
    parser.add_argument(
        "--features",
        type=Path,
        metavar="FILE",
        help="lines seconds,feature,left,top,right,bottom in pixels that say where features are: "
        "brow_left, eye_left, nostril_left and the same of the right, lips, mouth (what is open of "
        "it); (default: as the landmark networks see them)",
    )
    parser.add_argument(
        "--focal", type=focal, metavar="PIXELS|FILE", help="focal length of the camera"
    )


def pose(text: str) -> tuple[str, tuple[float, float]]:
    """ "smile=4-4.5" as ("smile", (4.0, 4.5))."""
    name, equals, seconds = text.partition("=")
    if not (name and equals and len(name) <= 32):
        raise argparse.ArgumentTypeError(f"'{text}' is not NAME=SECONDS, such as smile=4-4.5")
    return name, span(seconds)


def run(options: argparse.Namespace) -> None:
    from mien.recipe import calibrate

    output: Path = options.output
    if output.suffix.lower() != ENDING:
        raise InputError(f"-o {output}: a performer is kept as {ENDING}")
    for take in options.takes:
        spare(take, [output])
    with results(output.parent) as claim, progress("learning the performer") as told:
        performer = calibrate(
            options.takes,
            claim(output.name),
            neutral=options.neutral,
            shut=options.shut,
            poses=dict(options.pose),
            features=options.features,
            focal=options.focal,
            progress=told,
        )
    by = ["curves"] + ["landmarks"] * bool(performer.landmarks)
    taught = sorted(n[: -len("_hidden")] for n in performer.curves if n.endswith("_hidden"))
    tell(
        options,
        {
            "takes": options.takes,
            "learnt_by": by,
            "networks": taught,
            "poses": sorted(performer.poses),
            "files": [str(output)],
        },
        f"learnt the face at rest and the lids, by {' and '.join(by)}",
        f"learnt colours of {', '.join(taught)}" if taught else "colours are the usual ones",
        *(f"learnt the pose {name}" for name in sorted(dict(options.pose))),
        str(output),
    )
