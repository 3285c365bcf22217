"""Let many takes drive many characters, on all processors or on many machines."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from mien.cli.animate import add_cast_options, add_mapping_options
from mien.cli.capture import add_cut_options
from mien.cli.command import tell
from mien.cli.progress import progress
from mien.errors import MienError

PAGE, RECORD = "index.html", "batch.json"
INTERRUPTED = "what is done is kept; the same command goes on from there"


class IncompleteError(MienError):
    """Some takes failed; the others are done."""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "takes",
        nargs="+",
        metavar="TAKE",
        help="takes as for 'mien animate', and folders of them at any depth",
    )
    add_cut_options(parser)
    # Many takes are a matter of time: the tracker costs three times as much, for those who ask.
    parser.set_defaults(capture="landmarks")
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        required=True,
        metavar="FOLDER",
        help="results, batch.json and a report; a batch that was interrupted goes on there",
    )
    add_cast_options(parser)
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help="a Dask scheduler, such as tcp://10.0.0.7:8786, whose workers see the same files "
        "(default: processes of this machine)",
    )
    parser.add_argument(
        "--workers",
        type=workers,
        metavar="N",
        help="processes of this machine (default: as many as processors and memory allow)",
    )
    add_mapping_options(parser)


def workers(text: str) -> int:
    """A number of processes."""
    if not (text.isdecimal() and 0 < int(text) <= 4096):
        raise argparse.ArgumentTypeError(f"'{text}' is not a number from 1 to 4096")
    return int(text)


def run(options: argparse.Namespace) -> None:
    from mien.batch.order import Order, formats, roles
    from mien.batch.run import run_batch

    order = Order(
        roles(options.characters or ()),
        formats(options.formats),
        looking=_looking(options),
        markers=_markers(options),
        acting=_acting(options),
    )
    with progress("acting", rate="pairs") as told:
        account = run_batch(
            options.takes,
            order,
            options.output,
            scheduler=options.scheduler,
            workers=options.workers,
            told=told,
        )
    _complain(account, options.output)
    tell(options, _result(account, options.output), *_lines(account, options.output))


def _looking(options: argparse.Namespace) -> dict[str, Any]:
    focal = options.focal
    files = {name: getattr(options, name) for name in ("performer", "faces")}
    return {
        "method": options.capture,
        **_given(options, "start", "end", "mirror", "rate", "neutral"),
        **({} if focal is None else {"focal": _file(focal) if isinstance(focal, str) else focal}),
        **{name: _file(path) for name, path in files.items() if path is not None},
    }


def _markers(options: argparse.Namespace) -> dict[str, Any]:
    labels = {} if options.labels is None else {"labels": _file(options.labels)}
    return labels | _given(options, "units", "nose_tip", "start", "end", "neutral")


def _acting(options: argparse.Namespace) -> dict[str, Any]:
    names = ("mapping", "gain", "brows", "eyes", "mouth", "head", "own_range")
    return {name: getattr(options, name) for name in names} | {"smooth": not options.no_filter}


def _given(options: argparse.Namespace, *names: str) -> dict[str, Any]:
    return {name: getattr(options, name) for name in names if getattr(options, name)}


def _file(path: str | Path) -> Path:
    """Workers have folders of their own."""
    return Path(path).resolve()


def _complain(account: dict[str, Any], folder: Path) -> None:
    """Raise IncompleteError where something failed."""
    lost = [take for take in account["takes"] if "error" in take]
    missed = [
        f"{act['character']} of {take['name']} ({act['error']})"
        for take in account["takes"]
        for act in take.get("characters", ())
        if "error" in act
    ]
    reasons = [take["error"] for take in lost] + missed
    if reasons:
        more = f"; and {len(reasons) - 3} more" if len(reasons) > 3 else ""
        raise IncompleteError(
            f"{len(lost)} of {len(account['takes'])} takes and {len(missed)} single characters "
            f"failed: {'; '.join(reasons[:3])}{more}; all others are done, see {folder / PAGE}"
        )


def _result(account: dict[str, Any], folder: Path) -> dict[str, Any]:
    return {
        "takes": len(account["takes"]),
        "characters": account["characters"],
        "run": account["run"],
        "files": [str(folder / RECORD), str(folder / PAGE)],
    }


def _lines(account: dict[str, Any], folder: Path) -> list[str]:
    count = account["run"]["count"]
    return [
        f"{len(account['takes'])} takes by {', '.join(account['characters'])}: "
        f"{count['captured']} captured and {count['acted']} acted in "
        f"{account['run']['seconds']:.1f} s, {count['captures_found']} and {count['acts_found']} "
        "were there already",
        str(folder / PAGE),
    ]
