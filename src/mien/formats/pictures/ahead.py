"""Reading ahead: a thread prepares the next few items while the caller works on this one."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from queue import Empty, Full, Queue
from threading import Event, Thread
from typing import TypeVar

Item = TypeVar("Item")

_PATIENCE = 0.05
"""Seconds between two looks at whether the caller has gone."""


def read_ahead(items: Generator[Item, None, None], depth: int = 4) -> Iterator[Item]:
    """Yield ``items`` in order, up to ``depth`` of them made in advance by one thread.

    What ``items`` raises is raised here, after the items before it. However the iteration ends
    (exhausted, closed early, Ctrl-C in the caller), ``items`` is closed and the thread is gone
    when this generator is.
    """
    queue: Queue[tuple[Item | None, BaseException | None]] = Queue(depth)
    stop = Event()

    def offer(item: Item | None, error: BaseException | None) -> bool:
        while not stop.is_set():
            try:
                queue.put((item, error), timeout=_PATIENCE)
                return True
            except Full:
                continue
        return False

    def work() -> None:
        try:
            for item in items:
                if not offer(item, None):
                    return
            offer(None, StopIteration())
        except BaseException as error:  # handed to the caller's thread, whatever it is
            offer(None, error)
        finally:
            items.close()

    thread = Thread(target=work, name="mien-read-ahead", daemon=True)
    thread.start()
    try:
        while True:
            item, error = queue.get()
            if isinstance(error, StopIteration):
                return
            if error is not None:
                raise error
            assert item is not None
            yield item
    finally:
        stop.set()
        while thread.is_alive():
            try:
                queue.get(timeout=_PATIENCE)
            except Empty:
                thread.join(_PATIENCE)
