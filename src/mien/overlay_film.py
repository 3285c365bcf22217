"""A film of what a capture saw, written while the capture looks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from queue import Queue
from threading import Event, Thread

from mien.formats.pictures.mp4 import write_mp4
from mien.performance.frame import Frame
from mien.performance.trace import Trace
from mien.view.overlay import overlay

_AHEAD = 8
"""Traces that wait at most: memory does not grow with the take."""


class _Broken(Exception):
    """The capture did not come to its end, so there is no film of it."""


@contextmanager
def overlay_film(path: Path, frames: Iterable[Frame]) -> Iterator[Callable[[Trace], None]]:
    """Give a function to be told the trace of each of ``frames``, in their order; ``frames`` is
    read beside the capture that reads its own. ``path`` is whole when the block ends well, and
    not there otherwise. Raises OutputError where it cannot be written."""
    traces: Queue[Trace | None] = Queue(_AHEAD)
    failures: list[BaseException] = []
    broken, stopped = Event(), Event()

    def pictures() -> Iterator[Frame]:
        # After the last frame too the block's end is waited for: it may still end badly.
        for trace, frame in zip(iter(traces.get, None), frames, strict=False):
            if broken.is_set():
                break
            yield Frame(overlay(frame.image, trace), frame.time)
        if broken.is_set():
            raise _Broken

    def write() -> None:
        try:
            write_mp4(path, pictures())
        except BaseException as failure:
            failures.append(failure)
        finally:
            stopped.set()
            while not traces.empty():
                traces.get_nowait()

    def tell(trace: Trace | None) -> None:
        if not stopped.is_set():
            traces.put(trace)

    writer = Thread(target=write, daemon=True)
    writer.start()
    try:
        yield tell
    except BaseException:
        broken.set()
        tell(None)
        writer.join()
        raise
    tell(None)
    writer.join()
    if failures:
        raise failures[0]
