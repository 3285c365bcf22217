"""How fast the curves are followed beside the bare landmark networks.

    python benchmarks/snakes_speed.py --video take.mp4 [--frames 200] [--rounds 3] [--json]

Decoding left out, one core: both look at the same pictures in memory, in turns; figures are
medians over the rounds. Stages are milliseconds a frame of the functions that do them.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.detector import Detector
from mien.capture.snakes.head.patch import Placement
from mien.capture.snakes.stepper import SnakeCapture
from mien.formats.pictures.sources import open_source
from report import show

Picture = NDArray[np.uint8]
FIT = sys.modules["mien.capture.snakes.fit"]
STAGES: dict[str, tuple[tuple[Any, str], ...]] = {
    "rest": ((SnakeCapture, "step"),),
    "patch": ((Placement, "warp"), (FIT, "look_at")),
    "head": ((SnakeCapture, "_follow"),),
    "colour": ((FIT, "field_of"), (FIT, "brow_field"), (FIT, "pigments")),
    "curves": ((FIT, "settle"),),
    "mouth": tuple(
        (FIT, name)
        for name in ("find_gape", "lip_colour", "look_inside", "find_opening", "find_tongue")
    ),
    "eyes": ((FIT, "aperture"), (FIT, "find_irises")),
}
"""Stage -> owners and names of the functions that do it, without what they call of other stages."""


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--video", type=Path, required=True)
    parser.add_argument("--frames", type=int, default=200)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    cv2.setNumThreads(1)
    pictures = [
        f.image for _, f in zip(range(options.frames), open_source(options.video), strict=False)
    ]
    rate(pictures[:10], SnakeCapture().step)
    ours, theirs, ratios = [], [], []
    with Detector() as detector:
        rate(pictures[:10], detector.landmarks)
        for _ in range(options.rounds):
            theirs.append(rate(pictures, detector.landmarks))
            ours.append(rate(pictures, SnakeCapture().step))
            ratios.append(ours[-1] / theirs[-1])
    figures = {
        "fps": statistics.median(ours),
        "detector_fps": statistics.median(theirs),
        "detector_ratio": statistics.median(ratios),
        **stages(pictures),
    }
    show("snakes_speed", f"Curves on {options.video.name}", figures, options.json)


def rate(pictures: list[Picture], look: Callable[[Picture], object]) -> float:
    """Frames a second, by the processor's clock: others may be at work."""
    start = time.process_time()
    for picture in pictures:
        look(picture)
    return len(pictures) / (time.process_time() - start)


def stages(pictures: list[Picture]) -> dict[str, float]:
    """Milliseconds a frame of each stage."""
    with timed() as spent:
        stepper = SnakeCapture()
        stepper.step(pictures[0])
        spent.update(dict.fromkeys(STAGES, 0.0))
        for picture in pictures[1:]:
            stepper.step(picture)
    return {f"{name}_ms": 1e3 * spent[name] / (len(pictures) - 1) for name in STAGES}


@contextmanager
def timed() -> Iterator[dict[str, float]]:
    """Seconds of each stage, which grow as its functions are called: those of the innermost."""
    spent, running = dict.fromkeys(STAGES, 0.0), ["rest"]
    since = time.process_time()

    def charge() -> None:
        nonlocal since
        now = time.process_time()
        spent[running[-1]] += now - since
        since = now

    def watch(stage: str, function: Callable[..., Any]) -> Callable[..., Any]:
        def timed_call(*given: Any, **named: Any) -> Any:
            charge()
            running.append(stage)
            result = function(*given, **named)
            charge()
            running.pop()
            return result

        return timed_call

    kept = [
        (owner, name, getattr(owner, name), stage)
        for stage, members in STAGES.items()
        for owner, name in members
    ]
    for owner, name, function, stage in kept:
        setattr(owner, name, watch(stage, function))
    try:
        yield spent
    finally:
        for owner, name, function, _ in kept:
            setattr(owner, name, function)


if __name__ == "__main__":
    main()
