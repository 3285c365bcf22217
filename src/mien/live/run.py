"""The loop of live work: newest frame in, everybody told, nothing waits."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter, sleep
from typing import Protocol

import numpy as np

from mien.formats.takes.recording import Recorder
from mien.live.newest import Newest, keep_newest
from mien.live.stage import Moment, Stage
from mien.performance.arkit_frame import ArkitFrame
from mien.performance.frame import Frame

Live = Frame | ArkitFrame
_PATIENCE = 0.25
"""Seconds between two looks at the clock when no frame comes."""


class Output(Protocol):
    """Somebody who is told every moment in ARKit's words."""

    def send(self, frame: ArkitFrame) -> None:
        """Say ``frame``; must not wait."""


@dataclass(slots=True)
class Tally:
    """What a run did."""

    frames: int = 0
    following: int = 0
    recorded: int = 0
    dropped: int = 0
    lateness: list[float] = field(default_factory=list)
    """Seconds from a frame's arrival to the moment everybody was told, of the last thousand."""

    def late_ms(self, quantile: float) -> float:
        """A quantile of the lateness in milliseconds; 0 before the first frame."""
        return 1e3 * float(np.quantile(self.lateness, quantile)) if self.lateness else 0.0


_KEPT = 1000


def run(
    frames: Iterable[Live],
    stage: Stage,
    *,
    outputs: Iterable[Output] = (),
    record: Path | None = None,
    seconds: float | None = None,
    watch: Callable[[Moment, Tally], None] | None = None,
) -> Tally:
    """Step ``stage`` through the newest of ``frames`` until they end, for ``seconds``, or until
    Ctrl-C.

    ``record`` is a .take file that is appended as it goes; ``watch`` is told every moment. Raises
    what the source raises, and OutputError where the recording cannot be written.
    """
    tally, listeners = Tally(), tuple(outputs)
    recorder: Recorder | None = None
    slot = keep_newest(_arriving(frames))
    begin = perf_counter()
    try:
        for arrived, item in _taken(slot, begin, seconds):
            moment = stage.see(item) if isinstance(item, Frame) else stage.hear(item)
            if moment.arkit is not None:
                for listener in listeners:
                    listener.send(moment.arkit)
            if record is not None and moment.performance is not None:
                recorder = recorder or Recorder(record, moment.performance)
                recorder.write(moment.performance)
                tally.recorded += 1
            _count(tally, moment, slot.dropped, perf_counter() - arrived)
            if watch is not None:
                watch(moment, tally)
            stage.look_around()
    except KeyboardInterrupt:
        pass  # how a live run is ended
    finally:
        slot.close()
        if recorder is not None:
            recorder.close()
    return tally


def in_real_time(frames: Iterable[Frame]) -> Iterator[Frame]:
    """The frames of a recording at the moments at which a camera would give them."""
    begin = perf_counter()
    for frame in frames:
        wait = frame.time - (perf_counter() - begin)
        if wait > 0.0:
            sleep(wait)
        yield frame


def _arriving(items: Iterable[Live]) -> Iterator[tuple[float, Live]]:
    for item in items:
        yield perf_counter(), item


def _taken(
    slot: Newest[tuple[float, Live]], begin: float, seconds: float | None
) -> Iterator[tuple[float, Live]]:
    while seconds is None or perf_counter() - begin < seconds:
        taken = slot.take(_PATIENCE)
        if taken is not None:
            yield taken
        elif slot.finished:
            return


def _count(tally: Tally, moment: Moment, dropped: int, late: float) -> None:
    tally.frames += 1
    tally.following += moment.state == "following"
    tally.dropped = dropped
    tally.lateness.append(late)
    del tally.lateness[:-_KEPT]
