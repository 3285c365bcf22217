"""How fast the whole job is beside the bare landmark networks, and what memory it takes.

    python benchmarks/throughput.py --video take.mp4 [--rounds 3] [--json]

The job: decode, capture, map to four characters, write four GLBs. The detector: decode to RGB and
run the networks, nothing else. Both in one process, in turns; the ratio is the median over the
rounds. Memory is the peak of a fresh process on the take and on the take ten times over.
"""

from __future__ import annotations

import argparse
import json
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import av

import mien
from mien.capture import CAPTURES, CaptureSettings
from mien.capture.detector import Detector
from mien.formats.gltf.glb import write_glb
from mien.formats.pictures.sources import open_source
from mien.performance.frame import Frame
from report import show


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--video", type=Path, required=True)
    parser.add_argument("--capture", default="landmarks")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--no-memory", action="store_true", help="leave the two memory runs out")
    parser.add_argument("--repeat", type=int, default=1, help=argparse.SUPPRESS)
    parser.add_argument("--only-memory", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if options.only_memory:
        job(options.video, options.capture, options.repeat)
        print(json.dumps(high_water()))
        return

    job(options.video, options.capture, 1)
    ours, theirs = [], []
    for _ in range(options.rounds):
        theirs.append(rate(lambda: detect(options.video)))
        ours.append(rate(lambda: job(options.video, options.capture, 1)))
    figures = {
        "fps": statistics.median(ours),
        "detector_fps": statistics.median(theirs),
        "ratio": statistics.median(a / b for a, b in zip(ours, theirs, strict=True)),
    }
    if not options.no_memory:
        figures["peak_mb_1x"] = peak(options.video, options.capture, 1)
        figures["peak_mb_10x"] = peak(options.video, options.capture, 10)
    show("throughput", f"Throughput on {options.video.name}", figures, options.json)


@dataclass(frozen=True)
class Repeated:
    """A recording played several times over."""

    video: Path
    times: int

    def __iter__(self) -> Iterator[Frame]:
        shift = 0.0
        for _ in range(self.times):
            last = shift
            for frame in open_source(self.video):
                last = frame.time + shift
                yield Frame(frame.image, last)
            shift = last + 1.0 / 30.0


def job(video: Path, capture: str, times: int) -> int:
    """Capture, map to the four characters, write their GLBs; how many frames that were."""
    characters = [mien.load_character(name) for name in mien.CHARACTERS]
    performance = CAPTURES[capture](Repeated(video, times), CaptureSettings(), video.name)
    with tempfile.TemporaryDirectory() as folder:
        for character in characters:
            curves = mien.animate(performance, character)
            write_glb(Path(folder) / f"{character.name}.glb", character, curves)
    return len(performance)


def detect(video: Path) -> int:
    """The networks alone, on a plain decoding loop."""
    count = 0
    with Detector() as detector, av.open(str(video)) as container:
        for picture in container.decode(video=0):
            detector.landmarks(picture.to_ndarray(format="rgb24"))
            count += 1
    return count


def rate(work) -> float:  # type: ignore[no-untyped-def]
    """Frames a second of ``work``, which returns how many it did."""
    start = time.perf_counter()
    return work() / (time.perf_counter() - start)


def peak(video: Path, capture: str, times: int) -> float:
    """Peak memory in MB of a fresh process that does the job on the take ``times`` over."""
    command = [sys.executable, __file__, "--video", str(video), "--capture", capture]
    command += ["--only-memory", "--repeat", str(times)]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return float(done.stdout.strip().splitlines()[-1])


def high_water() -> float:
    """Peak memory of this process in MB. What getrusage tells includes its parent's on Linux."""
    status = Path("/proc/self/status")
    if status.is_file():
        line = next(x for x in status.read_text().splitlines() if x.startswith("VmHWM"))
        return int(line.split()[1]) / 1024.0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0


if __name__ == "__main__":
    main()
