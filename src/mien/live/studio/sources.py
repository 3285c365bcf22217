"""What the studio looks at: the page's camera, a recording in real time, or a take."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter, sleep
from typing import Protocol

import numpy as np

from mien.formats.pictures.jpeg import decode_jpeg, encode_jpeg
from mien.formats.pictures.sources import open_source
from mien.live.newest import Newest, keep_newest
from mien.live.run import in_real_time
from mien.performance.frame import Frame
from mien.performance.performance import Performance

_SHOWN_HEIGHT = 360


@dataclass(frozen=True, slots=True)
class Arrived:
    """Something to act on."""

    at: float
    """When it came, on the performance counter."""
    item: Frame | Performance
    shown: bytes = b""
    """The picture as a JPEG, where the page does not have it."""
    place: tuple[float, float] | None = None
    """Where in a take this is, and how long the take is, seconds."""


class Source(Protocol):
    """Somewhere a performer is."""

    def next(self, timeout: float) -> Arrived | None:
        """What is newest, waiting at most ``timeout`` seconds. Raises MienError."""

    def close(self) -> None:
        """No more."""


class PageCamera:
    """The camera of whoever has the page open; pictures come as JPEG."""

    def __init__(self) -> None:
        self._slot: Newest[tuple[float, float, bytes]] = Newest()

    def put(self, time: float, picture: bytes) -> None:
        """A picture taken at ``time`` seconds of the page's own clock."""
        self._slot.put((perf_counter(), time, picture))

    def next(self, timeout: float) -> Arrived | None:
        """See Source."""
        taken = self._slot.take(timeout)
        if taken is None:
            return None
        at, time, picture = taken
        return Arrived(at, Frame(decode_jpeg(picture), time))

    def close(self) -> None:
        """See Source."""
        self._slot.close()


class Film:
    """A recording, over and over, as fast as it was filmed."""

    def __init__(self, path: Path, mirror: bool) -> None:
        """Raises InputError, FormatError."""
        self._source = open_source(str(path), mirror=mirror)
        self._slot = keep_newest(self._arriving())

    def next(self, timeout: float) -> Arrived | None:
        """See Source."""
        taken = self._slot.take(timeout)
        if taken is None:
            return None
        at, frame = taken
        return Arrived(at, frame, encode_jpeg(frame.image, _SHOWN_HEIGHT))

    def close(self) -> None:
        """See Source."""
        self._slot.close()

    def _arriving(self) -> Iterator[tuple[float, Frame]]:
        begin = 0.0
        while True:
            last = 0.0
            for frame in in_real_time(self._source):
                last = frame.time
                # Time goes on when the film begins again.
                yield perf_counter(), Frame(frame.image, begin + frame.time)
            begin += last + 1.0 / 30.0


class Tape:
    """A take that is played, paused and wound."""

    def __init__(self, performance: Performance) -> None:
        self._performance = performance
        self._length = float(performance.time[-1])
        self._place, self._playing = 0.0, True
        self._clock = perf_counter()
        self._moved = True

    def seek(self, place: float, playing: bool) -> None:
        """Go to ``place`` seconds, and play from there or stay."""
        self._place, self._playing = min(max(place, 0.0), self._length), playing
        self._clock, self._moved = perf_counter(), True

    def next(self, timeout: float) -> Arrived | None:
        """See Source. A tape that stands still says so once."""
        sleep(min(timeout, 1.0 / 60.0))
        now = perf_counter()
        if self._playing:
            self._place += now - self._clock
            if self._place > self._length:
                self._place = 0.0
        elif not self._moved:
            return None
        self._clock, self._moved = now, False
        frame = int(np.searchsorted(self._performance.time, self._place, side="right")) - 1
        now_seen = self._performance[max(frame, 0) : max(frame, 0) + 1]
        return Arrived(now, now_seen, place=(self._place, self._length))

    def close(self) -> None:
        """See Source."""
