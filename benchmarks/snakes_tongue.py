"""Whether the curve capture tells a tongue from teeth and dark.

    python benchmarks/snakes_tongue.py --video take.mp4 --spans closures.json [--json]
    python benchmarks/snakes_tongue.py --film woman [--json]

With --spans: frames that people marked as `tongue_forward` under the take's name. With --film: a
character of mien's own is filmed, and its key says when the tongue is out. A run of frames above
one half that comes within 3 frames of no span is a false alarm.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien import load_character
from mien.capture import CAPTURES, CaptureSettings
from mien.formats.pictures.sources import open_source
from mien.performance.frame import Frame
from mien.rehearsal import Tempo, film, rehearse
from report import show

Array = NDArray[np.float64]
Span = tuple[int, int]

OUT, NEAR = 0.5, 3
ACT = ("jaw_open", "smile", "surprise", "tongue_out", "laugh")


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--video", type=Path)
    parser.add_argument("--spans", type=Path)
    parser.add_argument("--film", metavar="CHARACTER")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if options.film:
        tongue, spans = filmed(options.film)
        name = options.film
    else:
        tongue = measured(open_source(options.video))
        spans = [tuple(span) for span in told(options.spans, options.video.stem)]
        name = options.video.name
    show("snakes_tongue", f"Tongue in {name}", figures(tongue, spans), options.json)


def told(path: Path, take: str) -> Sequence[Span]:
    """The spans of ``take``."""
    return json.loads(path.read_text())[take]["tongue_forward"]


def filmed(name: str) -> tuple[Array, list[Span]]:
    """What is measured on a character's act, and where its key is above one half."""
    character = load_character(name)
    curves = rehearse(character, ACT, Tempo(hold=0.3, sway=0.15))
    key = curves.weights[:, curves.names.index("tongue_out")]
    return measured(film(character, curves)), runs(key > OUT)


def measured(frames: Iterable[Frame]) -> Array:
    """(F,) how far the tongue is out, by the curve capture."""
    return CAPTURES["snakes"](frames, CaptureSettings(), "tongue").scalars["tongue_out"]


def figures(tongue: Array, spans: Sequence[Span]) -> dict[str, float]:
    """Misses and false alarms, by spans and by frames."""
    out, near = np.zeros(len(tongue), dtype=bool), np.zeros(len(tongue), dtype=bool)
    for first, last in spans:
        out[first : last + 1] = True
        near[max(first - NEAR, 0) : last + 1 + NEAR] = True
    high = tongue > OUT
    return {
        "spans": float(len(spans)),
        "missed": float(sum(not high[first : last + 1].any() for first, last in spans)),
        "false_alarms": float(sum(not near[a : b + 1].any() for a, b in runs(high))),
        "found_frames_pct": 100.0 * float(high[out].mean()),
        "false_frames_pct": 100.0 * float(high[~near].mean()),
        "median_out": float(np.median(tongue[out])),
        "median_else": float(np.median(tongue[~near])),
    }


def runs(high: NDArray[np.bool_]) -> list[Span]:
    """First and last frames of each stretch."""
    edges = np.flatnonzero(np.diff(np.r_[0, high.astype(int), 0]))
    return [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]


if __name__ == "__main__":
    main()
