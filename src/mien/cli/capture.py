"""Read what a recorded face did, into a .mien file, a Live Link Face .csv or an MPEG-4 .fap."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from mien.cli.command import not_negative, positive, remark, span, tell
from mien.cli.markers import add_marker_options, describe_markers, performance_of_markers
from mien.cli.progress import progress
from mien.cli.results import results, spare
from mien.errors import InputError

if TYPE_CHECKING:
    from mien.performance.performance import Performance

TAKES = (
    "a video, a folder of images, camera:0 (with --end), markers (.c3d, .trc, .csv), a .mien file, "
    "a live recording (.take), a Live Link Face .csv or an MPEG-4 .fap"
)
CUT_OPTIONS = (
    *("start", "end", "mirror", "rate", "neutral"),
    *("focal", "performer", "faces", "overlay"),
)
"""Options that say how a recording is looked at."""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("take", metavar="TAKE", help=TAKES)
    add_cut_options(parser)
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help="a .mien, .csv or .fap file (default: TAKE.mien in this folder)",
    )

    parser.add_argument(
        "--overlay",
        type=Path,
        metavar="FILE",
        help="also write an .mp4 in which what was seen is drawn over the take",
    )


def add_cut_options(parser: argparse.ArgumentParser) -> None:
    """Which part of a recording to look at, and how."""
    parser.add_argument(
        "--capture",
        metavar="NAME",
        default="tracker",
        help="how the face is followed: tracker, landmarks or snakes (default: %(default)s)",
    )
    parser.add_argument(
        "--start", type=not_negative, metavar="SECONDS", help="begin there (default: 0)"
    )
    parser.add_argument(
        "--end", type=positive, metavar="SECONDS", help="end there (default: the take's end)"
    )
    parser.add_argument(
        "--mirror", action="store_true", help="the take is a selfie's mirror image: turn it back"
    )
    parser.add_argument(
        "--rate",
        type=positive,
        metavar="FPS",
        help="frames a second of a folder of images (default: 30); videos tell their own",
    )
    parser.add_argument(
        "--neutral",
        type=span,
        metavar="SECONDS",
        help="when the face rests, from --start on: 2.5, or 2.5-3 (default: found)",
    )
    parser.add_argument(
        "--focal",
        type=focal,
        metavar="PIXELS|FILE",
        help="focal length of the camera, or a file that says it: focal = 700, width = 640 "
        "(default: a usual one)",
    )
    parser.add_argument(
        "--performer",
        type=Path,
        metavar="FILE",
        help="what mien calibrate learnt of this person (default: learnt from the take)",
    )
    parser.add_argument(
        "--faces",
        type=Path,
        metavar="FILE",
        help="scanned faces of this person, as mien databank build keeps them, by which "
        "--capture tracker knows them",
    )
    add_marker_options(parser)
    parser.set_defaults(overlay=None)


def focal(text: str) -> float | str:
    """A number of pixels, or the name of a file."""
    return text if any(letter.isalpha() for letter in text) else positive(text)


def run(options: argparse.Namespace) -> None:
    from mien.recipe import WRITERS, save_performance

    output: Path = options.output or Path(f"{take_name(options.take)}.mien")
    if output.suffix.lower() not in WRITERS:
        raise InputError(f"-o {output}: a performance is kept as {' or '.join(WRITERS)}")
    film: Path | None = options.overlay
    if film is not None and film.suffix.lower() != ".mp4":
        raise InputError(f"--overlay {film}: the film is an .mp4")
    files = [output] if film is None else [output, film]
    spare(options.take, files)
    with results(output.parent) as claim:
        performance, account = performance_of(options)
        save_performance(performance, claim(output.name))
    summary = summarize(performance) | account
    tell(
        options,
        {"take": options.take, **summary, "files": [str(file) for file in files]},
        f"{options.take}: {describe(summary)}",
        *map(str, files),
    )


def performance_of(options: argparse.Namespace) -> tuple[Performance, dict[str, Any]]:
    """Capture the take as the options say, or only read one that is captured already; and what is
    to be told of how it was captured."""
    from mien.formats.markers.file import holds_markers
    from mien.recipe import READERS, capture, load_performance

    if holds_markers(options.take):
        return performance_of_markers(options)
    if Path(options.take).suffix.lower() in READERS:
        for name in CUT_OPTIONS:
            if getattr(options, name):
                raise InputError(f"--{name}: {options.take} was captured before; it stays as it is")
        return load_performance(options.take), {}
    remark(options, f"following the face in {options.take}")
    said: list[str] = []
    with progress("following the face") as told:
        performance = capture(
            options.take,
            method=options.capture,
            start=options.start,
            end=options.end,
            mirror=options.mirror,
            rate=options.rate,
            neutral=options.neutral,
            focal=options.focal,
            performer=options.performer,
            faces=options.faces,
            overlay=options.overlay,
            progress=told,
            notice=said.append,
        )
    for line in said:
        print(f"mien: {options.take}: {line}", file=sys.stderr)
    return performance, {}


def take_name(take: str) -> str:
    """What to call the results of a take: "clip" for "videos/clip.mp4", "camera0"."""
    if take.startswith("camera:"):
        return take.replace(":", "")
    return Path(take).resolve().stem


def summarize(performance: Performance) -> dict[str, Any]:
    """Facts of a take for --json."""
    return {
        "frames": len(performance),
        "seconds": round(float(performance.time[-1]), 6),
        "lost_frames": int(performance.lost.sum()),
        "faces": performance.faces,
    }


def describe(summary: dict[str, Any]) -> str:
    """The same in words."""
    lost = summary["lost_frames"]
    seen = f"no face in {lost} of them" if lost else "a face in all of them"
    length = f"{summary['frames']} frames, {summary['seconds']:.2f} s, {seen}"
    if summary["faces"] > 1:
        length += f"; one of {summary['faces']} faces was followed"
    if "markers" not in summary:
        return length
    return f"{length}; {describe_markers(summary['markers'])}"
