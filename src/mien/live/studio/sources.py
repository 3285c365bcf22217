"""What the studio looks at: the page's camera, a recording in real time, or a take."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from threading import Event
from time import perf_counter, sleep
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from mien.formats.pictures.jpeg import decode_jpeg, encode_jpeg
from mien.formats.pictures.sources import open_source
from mien.live.newest import Newest, keep_newest
from mien.live.run import in_real_time
from mien.performance.frame import Frame
from mien.performance.performance import Performance

_SHOWN_HEIGHT = 360
_Shown = tuple[float, float, NDArray[np.uint8]]
"""When a picture of a film came, its place in the film, and it."""


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


@runtime_checkable
class Recorded(Source, Protocol):
    """Somewhere a performer was."""

    def seek(self, place: float, playing: bool) -> None:
        """Go to ``place`` seconds, and play from there or stay."""


class PageCamera:
    """The camera of whoever has the page open; pictures come as JPEG."""

    def __init__(self) -> None:
        self._slot: Newest[tuple[float, float, bytes]] = Newest()
        self._latest = -1.0

    def put(self, time: float, picture: bytes) -> None:
        """A picture taken at ``time`` seconds of the page's own clock. Pictures are compressed
        beside each other: one that comes after a later one is passed over."""
        if time <= self._latest:
            return
        self._latest = time
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
    """A video, over and over, as fast as it was filmed; it can be paused and wound."""

    def __init__(self, path: Path, mirror: bool) -> None:
        """Raises InputError, FormatError."""
        self._path, self._mirror = str(path), mirror
        source = open_source(self._path, mirror=mirror)
        self._rate = source.rate
        self._length = (source.count or 0) / source.rate
        self._time, self._place = 0.0, 0.0
        self._stop = Event()
        self._slot = self._begin(0.0, playing=True)

    def next(self, timeout: float) -> Arrived | None:
        """See Source."""
        taken = self._slot.take(timeout)
        if taken is None:
            return None
        at, place, image = taken
        # Time goes on when the film begins again or is wound.
        self._time += min(max(place - self._place, 1.0 / self._rate), 1.0)
        self._place = place
        shown = encode_jpeg(image, _SHOWN_HEIGHT)
        return Arrived(at, Frame(image, self._time), shown, (place, max(self._length, place)))

    def seek(self, place: float, playing: bool) -> None:
        """See Recorded."""
        self.close()
        last = max(self._length - 1.0 / self._rate, 0.0)
        self._slot = self._begin(min(max(place, 0.0), last), playing)

    def close(self) -> None:
        """See Source."""
        self._stop.set()
        self._slot.close()

    def _begin(self, place: float, playing: bool) -> Newest[_Shown]:
        self._stop, self._place = Event(), place
        shown = self._shown(place, self._stop)
        return keep_newest(shown if playing else islice(shown, 1))

    def _shown(self, begin: float, stop: Event) -> Iterator[tuple[float, float, NDArray[np.uint8]]]:
        while not stop.is_set():
            for frame in in_real_time(open_source(self._path, start=begin, mirror=self._mirror)):
                if stop.is_set():
                    return
                yield perf_counter(), begin + frame.time, frame.image
            begin = 0.0


class Tape:
    """A take that is played, paused and wound."""

    def __init__(self, performance: Performance) -> None:
        self._performance = performance
        self._length = float(performance.time[-1])
        self._place, self._playing = 0.0, True
        self._clock = perf_counter()
        self._moved = True

    @property
    def points(self) -> tuple[str, ...]:
        """Its feature points."""
        return self._performance.points

    def seek(self, place: float, playing: bool) -> None:
        """See Recorded."""
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
