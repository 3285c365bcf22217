"""Marker takes at the command line: what may be said of them, and what was mended."""

from __future__ import annotations

import argparse
from collections import Counter
from typing import TYPE_CHECKING, Any

from mien.cli.command import remark
from mien.errors import InputError

if TYPE_CHECKING:
    from mien.capture.markers.perform import Mended
    from mien.performance.performance import Performance

_PICTURES_ONLY = ("mirror", "rate", "focal", "performer", "overlay")


def add_marker_options(parser: argparse.ArgumentParser) -> None:
    """What a marker file may not tell of itself."""
    parser.add_argument(
        "--units",
        metavar="NAME",
        help="of a marker file's numbers: mm, cm, m, in (default: as the file says)",
    )
    parser.add_argument(
        "--labels",
        metavar="FILE",
        help="which marker is which, where names do not tell: lines LABEL,8.3 or LABEL,jig",
    )
    parser.add_argument(
        "--nose-tip",
        action="store_true",
        help="take the head's turn from the jig and its place from the nose tip, frame by frame",
    )


def performance_of_markers(options: argparse.Namespace) -> tuple[Performance, dict[str, Any]]:
    """The performance in a marker take, and what to tell of it."""
    from mien.recipe import capture_markers

    for name in _PICTURES_ONLY:
        if getattr(options, name):
            raise InputError(f"--{name}: {options.take} holds markers, not pictures")
    remark(options, f"reading the markers of {options.take}")
    performance, mended = capture_markers(
        options.take,
        units=options.units,
        labels=options.labels,
        nose_tip=options.nose_tip,
        start=options.start,
        end=options.end,
        neutral=options.neutral,
    )
    for event in mended.events:
        remark(options, f"{event.kind} {' '.join(event.labels)}: {event.first} to {event.last}")
    return performance, {"markers": _account(mended)}


def _account(mended: Mended) -> dict[str, Any]:
    return {
        "points": dict(mended.points),
        "noise_mm": round(mended.noise, 4),
        "neutral_s": [round(second, 4) for second in mended.rest],
        "mended": [
            {
                "kind": event.kind,
                "labels": list(event.labels),
                "first": event.first,
                "last": event.last,
            }
            for event in mended.events
        ],
    }


def describe_markers(account: dict[str, Any]) -> str:
    """The same in words."""
    counts = Counter(event["kind"] for event in account["mended"])
    mended = ", ".join(f"{count} {kind}{'s' * (count > 1)}" for kind, count in counts.items())
    begin, end = account["neutral_s"]
    return (
        f"{len(account['points'])} feature points, at rest {begin:.2f} to {end:.2f} s, "
        f"mended: {mended or 'nothing'}"
    )
