"""How late a live face is, and how many weights a second arrive.

    python benchmarks/live_latency.py [--video take.mp4] [--seconds 20] [--json]

A page without a browser: pictures of a recording (the sample, when none is named) at 640x480 and
30 a second go into the socket of a studio that runs in a process of its own, as JPEG, and weights
come out of it. Lateness is from a picture's arrival at the server to its weights on the socket, as
the server counts it, and from sending to receiving, as the page does. Beside it the bare detector's
time a frame on the same pictures in the same run: one picture after the other, as the limit has
it, and at 30 a second, when caches are cold and cores asleep as they are live.
"""

from __future__ import annotations

import argparse
import statistics
import struct
import tempfile
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from importlib import resources
from itertools import count
from math import inf
from pathlib import Path

import cv2
import numpy as np

import mien
from mien.capture.detector import Detector
from mien.formats.pictures.sources import open_source
from mien.live.studio import packet
from report import show
from socket_page import Page, Studio, running_studio

SIZE, RATE = (640, 480), 30.0
SETTLING = 1.0
"""Seconds after the first weights that are left out: what runs for the first time is slow."""
PATIENCE = 60.0
"""Seconds for which the first weights may be waited for."""


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--video", type=Path)
    parser.add_argument("--capture", default="landmarks")
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    pictures = jpegs(options.video)

    detector, paced = detector_ms(pictures, 0.0), detector_ms(pictures, 1.0 / RATE)
    four = live(pictures, options.capture, list(mien.CHARACTERS), options.seconds)
    one = live(pictures, options.capture, [mien.CHARACTERS[0]], options.seconds)
    figures = {
        "p50_ms": float(np.quantile(four.server, 0.5)),
        "p95_ms": float(np.quantile(four.server, 0.95)),
        "p99_ms": float(np.quantile(four.server, 0.99)),
        "p95_one_ms": float(np.quantile(one.server, 0.95)),
        "page_p50_ms": float(np.quantile(four.page, 0.5)),
        "page_p95_ms": float(np.quantile(four.page, 0.95)),
        "detector_ms": detector,
        "limit_p95_ms": 1.3 * detector + 3.0,
        "detector_paced_ms": paced,
        "fps_one": one.rate,
        "fps_four": four.rate,
        "dropped": float(four.sent - len(four.server)),
        "sent": float(four.sent),
    }
    show("live_latency", "Live, four characters on stage", figures, options.json)


def jpegs(video: Path | None) -> list[bytes]:
    """The frames of ``video`` (the sample: None), cut to SIZE, as a page would send them."""
    if video is None:
        with resources.as_file(resources.files("mien").joinpath("data", "sample.mp4")) as sample:
            return jpegs(sample)
    found = []
    for frame in open_source(video):
        height, width = frame.image.shape[:2]
        scale = max(SIZE[0] / width, SIZE[1] / height)
        image = cv2.resize(frame.image, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA)
        left, top = (image.shape[1] - SIZE[0]) // 2, (image.shape[0] - SIZE[1]) // 2
        image = image[top : top + SIZE[1], left : left + SIZE[0], ::-1]
        found.append(cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, 80])[1].tobytes())
    return found


def detector_ms(pictures: Sequence[bytes], pace: float) -> float:
    """Median milliseconds of the bare detector, decoded pictures in memory, one every ``pace``
    seconds."""
    images = [
        cv2.imdecode(np.frombuffer(jpeg, np.uint8), cv2.IMREAD_COLOR_RGB) for jpeg in pictures[:200]
    ]
    spent = []
    with Detector() as detector:
        start = time.perf_counter()
        for number, image in enumerate(images):
            time.sleep(max(start + number * pace - time.perf_counter(), 0.0))
            begin = time.perf_counter()
            detector.landmarks(image)
            spent.append(time.perf_counter() - begin)
    return 1e3 * statistics.median(spent[10:])


@dataclass
class Run:
    """What came back; milliseconds each."""

    sent: int = 0
    server: list[float] = field(default_factory=list)
    page: list[float] = field(default_factory=list)
    rate: float = 0.0
    begin: float = inf
    """When counting begins, on the performance counter."""


def live(pictures: Sequence[bytes], capture: str, characters: list[str], seconds: float) -> Run:
    """``acted`` in a studio of its own."""
    with tempfile.TemporaryDirectory() as folder, running_studio(Path(folder)) as studio:
        return acted(studio, pictures, capture, characters, seconds)


def acted(
    studio: Studio, pictures: Sequence[bytes], capture: str, characters: list[str], seconds: float
) -> Run:
    """Send ``pictures`` in real time, over and over, until weights have come for ``seconds``."""
    run = Run()
    page = Page(studio.port)
    page.say(
        {"kind": "Way", "capture": capture, "mapping": "cardinal", "gain": 1.0, "mirror": False}
    )
    page.say({"kind": "Look", "source": "camera", "name": ""})
    page.say({"kind": "Cast", "characters": characters})
    listening = threading.Thread(target=_listen, args=(page, run), daemon=True)
    listening.start()
    start = time.perf_counter()
    for number in count():
        time.sleep(max(start + number / RATE - time.perf_counter(), 0.0))
        now = time.perf_counter()
        if now > run.begin + seconds:
            break
        if run.begin == inf and now > start + PATIENCE:
            raise SystemExit("no weights came")
        run.sent += now >= run.begin
        page.show(struct.pack("<d", now) + pictures[number % len(pictures)])
    time.sleep(0.5)
    page.go()
    listening.join(10)
    run.rate = len(run.server) / seconds
    return run


def _listen(page: Page, run: Run) -> None:
    with suppress(OSError):
        for message in page.hear():
            if isinstance(message, bytes):
                _count(run, dict(packet.unpack(message)))


def _count(run: Run, sections: dict[str, bytes]) -> None:
    if "C000" not in sections:
        return
    sent, late, _ = struct.unpack("<dfI", sections["MOMT"])
    if run.begin == inf:
        run.begin = time.perf_counter() + SETTLING
    if sent >= run.begin:
        run.server.append(late)
        run.page.append(1e3 * (time.perf_counter() - sent))


if __name__ == "__main__":
    main()
