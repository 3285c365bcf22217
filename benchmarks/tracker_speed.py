"""What the tracker costs beside the bare landmark networks.

    python benchmarks/tracker_speed.py --video take.mp4 [--rounds 3] [--json]

Decoding is left out of both: the same pictures go to the networks, then with their landmarks to the
tracker (cut, meet, follow). One process, one core, in turns; figures are medians over the rounds.
"""

from __future__ import annotations

import argparse
import os
import statistics
import time
from collections.abc import Callable
from pathlib import Path

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ.setdefault(threads, "1")

from mien.capture.detector import Detector, follow  # noqa: E402
from mien.capture.landmarks import calibrate, rest_of  # noqa: E402
from mien.capture.neutral import ground  # noqa: E402
from mien.capture.track import LandmarkTrack  # noqa: E402
from mien.capture.tracker.capture import Faces, follow_take  # noqa: E402
from mien.capture.tracker.look import take  # noqa: E402
from mien.capture.tracker.meet import generic_person  # noqa: E402
from mien.capture.tracker.track import Tracker  # noqa: E402
from mien.face.library import generic_face  # noqa: E402
from mien.formats.pictures.sources import open_source  # noqa: E402
from mien.performance.frame import Frame  # noqa: E402
from report import show  # noqa: E402

MOST_FRAMES = 300


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--video", type=Path, required=True)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    frames = [f for f, _ in zip(open_source(options.video), range(MOST_FRAMES), strict=False)]
    track = follow(frames)

    detector, whole, step = [], [], []
    track_take(frames, track)
    for _ in range(options.rounds):
        detector.append(clock(lambda: detect(frames)) / len(frames))
        seconds, stepping = track_take(frames, track)
        whole.append(seconds / len(frames))
        step.append(stepping / len(frames))
    figures = {
        "tracker_ms": 1e3 * statistics.median(whole),
        "step_ms": 1e3 * statistics.median(step),
        "detector_ms": 1e3 * statistics.median(detector),
        "detector_ratio": statistics.median(a / b for a, b in zip(whole, detector, strict=True)),
        "step_detector_ratio": statistics.median(
            a / b for a, b in zip(step, detector, strict=True)
        ),
    }
    show("tracker_speed", f"The tracker on {options.video.name}", figures, options.json)


def clock(work: Callable[[], object]) -> float:
    """Processor seconds of ``work``: others on this machine do not count."""
    start = time.process_time()
    work()
    return time.process_time() - start


def detect(frames: list[Frame]) -> None:
    """The networks alone."""
    with Detector() as detector:
        for frame in frames:
            detector.landmarks(frame.image)


def track_take(frames: list[Frame], track: LandmarkTrack) -> tuple[float, float]:
    """Processor seconds of all that the tracker adds to the networks, and of its steps alone."""
    base = ground(generic_face())
    start = time.process_time()
    faces = Faces()
    for frame, points, lost in zip(frames, track.points, track.lost, strict=True):
        faces.look(frame, None if lost else points)
    rest, known = rest_of(track, base), calibrate(track, base)
    somebody = generic_person(known, track.size)
    done = follow_take(track, faces, somebody, rest)
    whole = time.process_time() - start
    following = Tracker(
        done.met.person, [take(done.met.person, done.met.crop, done.met.rest)], done.met.rest
    )
    points = track.points[~track.lost][:, somebody.rows, :2].astype(float)
    crops = [faces[i] for i in range(len(points))]
    start = time.process_time()
    for crop, seen in zip(crops, points, strict=True):
        following.step(crop, seen)
    return whole, time.process_time() - start


if __name__ == "__main__":
    main()
