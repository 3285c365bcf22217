"""Whether the studio stands up to half an hour of everything at once.

    python benchmarks/soak.py [--frames 54000] [--minutes 60] [--json]

Two pages send pictures as fast as the studio takes them: 54,000 are half an hour of a camera.
Meanwhile pages are reloaded and torn away without a word, one does not read, malformed and
oversized messages come, films are uploaded and broken off, a take is recorded all the time and
begun anew. Told are the studio's memory every minute and at the end, pictures seen, and takes that
were not whole; then the studio is killed hard in the middle of a recording.
"""

from __future__ import annotations

import argparse
import http.client
import json
import random
import struct
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from threading import Event, Thread

import numpy as np

from live_latency import jpegs
from mien.errors import MienError
from mien.formats.takes.recording import read_recording
from mien.live.studio import packet
from report import show
from socket_page import Page, Studio, running_studio

_WARM = 0.2
"""Part of the pictures after which memory should not grow any more."""
_RATE = 30.0


class Performer:
    """A page whose camera never sleeps: each picture is sent when the one before was answered."""

    def __init__(self, studio: Studio, pictures: Sequence[bytes], capture: str, name: str) -> None:
        self._studio, self._pictures, self._capture = studio, pictures, capture
        self._name = name
        self.seen = self.reloads = 0
        self.done = Event()
        self._thread = Thread(target=self._act, name=name, daemon=True)
        self._thread.start()

    def end(self) -> None:
        """Wait until it has gone."""
        self.done.set()
        self._thread.join(60)

    def _act(self) -> None:
        random_ = random.Random(self._name)
        while not self.done.is_set():
            with suppress(OSError):
                self._visit(random_)
            self.reloads += 1

    def _visit(self, random_: random.Random) -> None:
        """One load of the page: some hundred pictures, a recording, some nonsense; then it goes."""
        page = Page(self._studio.port, patience=5.0)
        _set_up(page, self._capture, random_.sample(["man", "woman", "monkey", "toy"], 2))
        last = random_.randrange(200, 1500)
        for number, _ in _filmed(page, self._pictures):
            self.seen += 1
            if self.done.is_set() or number == last:
                break
            if number % 97 == 96:
                _talk_nonsense(page, random_)
            if number % 211 == 210:
                page.say({"kind": "Recording", "on": True})
        page.go(politely=random_.random() < 0.5)


def _filmed(page: Page, pictures: Sequence[bytes]) -> Iterator[tuple[int, bytes]]:
    """Answers to pictures, numbered; each picture is sent when the one before was answered."""
    number = -1
    for message in page.hear():
        if isinstance(message, bytes):
            yield number, message
        elif number >= 0 or json.loads(message).get("source") != "camera":
            continue
        number += 1
        picture = pictures[number % len(pictures)]
        page.show(struct.pack("<d", number / _RATE) + picture)


def _set_up(page: Page, capture: str, characters: list[str]) -> None:
    way = {"capture": capture, "mapping": "cardinal", "gain": 1.0, "mirror": False}
    page.say({"kind": "Way", **way})
    page.say({"kind": "Look", "source": "camera", "name": ""})
    page.say({"kind": "Cast", "characters": characters})
    page.say({"kind": "Recording", "on": True})


def _talk_nonsense(page: Page, random_: random.Random) -> None:
    if random_.random() < 0.2:
        page.show(b"\x00" * random_.choice((0, 5, 30, 5 << 20, 9 << 20)))
        return
    nonsense = (
        "{",
        "[" * 50_000,
        '{"kind": "Look", "source": "video", "name": "../../secret.mp4"}',
        '{"kind": "Seek", "time": 1e300, "playing": true}',
        '{"kind": "Cast", "characters": ["nobody"]}',
    )
    page.say_raw(random_.choice(nonsense))


def _stall(studio: Studio, pictures: Sequence[bytes], done: Event) -> None:
    """A page that asks for a film and never reads what it is sent."""
    while not done.is_set():
        with suppress(OSError):
            page = Page(studio.port)
            page.say({"kind": "Look", "source": "sample", "name": ""})
            done.wait(20.0)
            page.go(politely=False)


def _break_off(studio: Studio, done: Event) -> None:
    """Uploads that promise more than they bring."""
    while not done.wait(2.0):
        with suppress(OSError, http.client.HTTPException):
            door = http.client.HTTPConnection("127.0.0.1", studio.port, timeout=10)
            door.putrequest("PUT", "/videos/half.mp4")
            door.putheader("Content-Length", str(50 << 20))
            door.endheaders()
            door.send(b"\x00" * (1 << 20))
            door.close()


def memory_mb(process: int) -> float:
    """What a process holds in memory."""
    status = Path(f"/proc/{process}/status").read_text(encoding="ascii")
    line = next(line for line in status.splitlines() if line.startswith("VmRSS"))
    return int(line.split()[1]) / 1024.0


def soak(pictures: Sequence[bytes], options: argparse.Namespace) -> dict[str, float]:
    """The figures."""
    with tempfile.TemporaryDirectory() as name, running_studio(Path(name)) as studio:
        begin, done = time.monotonic(), Event()
        actors = [Performer(studio, pictures, options.capture, who) for who in ("first", "second")]
        for target, given in ((_stall, (studio, pictures, done)), (_break_off, (studio, done))):
            Thread(target=target, args=given, daemon=True).start()
        told: list[tuple[int, float]] = []
        seen = minute = 0
        while seen < options.frames and time.monotonic() < begin + 60.0 * options.minutes:
            seen = sum(actor.seen for actor in actors)
            if studio.process.poll() is not None:
                raise SystemExit(f"the studio died after {seen} pictures")
            told.append((seen, memory_mb(studio.process.pid)))
            if time.monotonic() > begin + 60.0 * minute:
                print(f"{minute:4} min {seen:7} pictures {told[-1][1]:7.0f} MB", file=sys.stderr)
                minute += 1
            time.sleep(1.0)
        seconds = time.monotonic() - begin
        done.set()
        for actor in actors:
            actor.end()
        lost = sum(not _whole(path) for path in Path(name).glob("*.take"))
        takes = len(list(Path(name).glob("*.take")))
        left = [path.name for path in Path(name).iterdir() if path.suffix != ".take"]
    warm = np.array([row for row in told if row[0] > _WARM * seen])
    slope = float(np.polyfit(warm[:, 0], warm[:, 1], 1)[0]) if len(warm) > 2 else float("nan")
    return {
        "pictures": float(seen),
        "minutes_of_camera": seen / _RATE / 60.0,
        "minutes_it_took": seconds / 60.0,
        "reloads": float(sum(actor.reloads for actor in actors)),
        "warm_mb": float(np.median(warm[: max(len(warm) // 10, 1), 1])),
        "end_mb": float(np.median(warm[-max(len(warm) // 10, 1) :, 1])),
        "mb_per_1000_pictures": 1000.0 * slope,
        "takes": float(takes),
        "takes_lost": float(lost),
        "files_left": float(len(left)),
    }


def _whole(path: Path) -> bool:
    try:
        return len(read_recording(path)) > 0
    except MienError:
        return False


def killed(pictures: Sequence[bytes], capture: str) -> float:
    """Seconds of a recording that are lost when the studio is killed in the middle of it."""
    with tempfile.TemporaryDirectory() as name, running_studio(Path(name)) as studio:
        page = Page(studio.port)
        _set_up(page, capture, ["man"])
        followed = 0
        for number, answer in _filmed(page, pictures):
            _, _, state = struct.unpack("<dfI", dict(packet.unpack(answer))["MOMT"])
            followed += packet.STATES[state] != "waiting"
            if number == 150:
                break
        studio.process.kill()
        studio.process.wait(10)
        (take,) = Path(name).glob("*.take")
        return max(followed - len(read_recording(take)), 0) / _RATE


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--video", type=Path)
    parser.add_argument("--capture", default="landmarks")
    parser.add_argument("--frames", type=int, default=54000)
    parser.add_argument("--minutes", type=float, default=60.0, help="stop then at the latest")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    pictures = jpegs(options.video)
    figures = {"lost_when_killed_s": killed(pictures, options.capture)}
    figures |= soak(pictures, options)
    show("soak", "Half an hour of everything at once", figures, options.json)


if __name__ == "__main__":
    main()
