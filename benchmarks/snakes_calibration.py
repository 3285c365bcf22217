"""What a performer's file is worth on another take: learnt on a video's first half, used on its
second.

    python benchmarks/snakes_calibration.py --video take.mp4 [--labels closures.json]
        [--character man] [--json]

Errors of the curves against the landmark networks' contours as benchmarks/snakes_accuracy.py has
them, and closures as benchmarks/eyes.py counts them where the labels tell of the video, each once
with the file and once without.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator, Mapping
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import mien
from eyes import event_figures, lid_closure
from mien.capture import CAPTURES, CaptureSettings
from mien.capture.known import curve_calibration
from mien.capture.learn import Lessons, learn
from mien.capture.snakes.colour.palette import trained
from mien.capture.snakes.stepper import SnakeCapture
from mien.formats.pictures.sources import open_source
from mien.performance.frame import Frame
from mien.performance.performer import Performer
from report import show
from snakes_accuracy import PARTS, network_contours, take_figures

TOLD = (*(f"{part}_pct" for part in PARTS), "lips_off", "recovered_fraction")


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--video", type=Path, required=True)
    parser.add_argument("--labels", type=Path, help="closures.json (default: beside the video)")
    parser.add_argument("--character", default="man")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    halves = Halves(options.video)
    performer = learn(halves.first, Lessons(), options.video.name)
    contours = network_contours(halves.second())
    _, look, networks = curve_calibration(performer.curves)
    ways = {"without": SnakeCapture, "with": partial(SnakeCapture, look, trained(networks))}
    path = options.labels or options.video.with_name("closures.json")
    labels = json.loads(path.read_text()).get(options.video.stem, {}) if path.is_file() else {}
    figures = {}
    for way, make in ways.items():
        found = take_figures(halves.second(), contours, make)
        told = {name: found[name] for name in TOLD}
        if labels.get("closures"):
            known = performer if way == "with" else None
            told |= closures(halves, known, options.character, labels)
        figures |= {f"{way}_{name}": value for name, value in told.items()}
    title = f"The second half of {options.video.name}, known from the first"
    show("snakes_calibration", title, figures, options.json)


class Halves:
    """The frames of a video before its middle, and from it on."""

    def __init__(self, video: Path) -> None:
        self._video = video
        self.middle = sum(1 for _ in open_source(video)) // 2

    def first(self) -> Iterator[Frame]:
        """Those before the middle."""
        return islice(open_source(self._video), self.middle)

    def second(self) -> Iterator[Frame]:
        """Those from the middle on."""
        return islice(open_source(self._video), self.middle, None)


def closures(
    halves: Halves, performer: Performer | None, name: str, labels: Mapping[str, Any]
) -> dict[str, float]:
    """Of the second half, as the character's lids are drawn."""
    settings = CaptureSettings(performer=performer)
    performance = CAPTURES["snakes"](halves.second(), settings, "second half")
    character = mien.load_character(name)
    shown = lid_closure(character, mien.animate(performance, character))
    return event_figures(shown, later(labels, halves.middle))


def later(labels: Mapping[str, Any], first: int) -> dict[str, Any]:
    """``labels`` of the frames from ``first`` on, which becomes frame 0."""
    told = [closure for closure in labels["closures"] if closure["first"] >= first]
    return {
        "closures": [
            closure | {end: closure[end] - first for end in ("first", "last")} for closure in told
        ],
        "dont_care": [
            [a - first, b - first] for a, b, *_ in labels.get("dont_care", []) if a >= first
        ],
        "dont_care_eye": [
            [eye, a - first, b - first]
            for eye, a, b, *_ in labels.get("dont_care_eye", [])
            if a >= first
        ],
    }


if __name__ == "__main__":
    main()
