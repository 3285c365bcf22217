"""A slot that holds one thing: the newest. What nobody took in time is dropped and counted."""

from __future__ import annotations

from collections.abc import Iterable
from threading import Condition, Thread
from typing import Generic, TypeVar

Item = TypeVar("Item")


class Newest(Generic[Item]):
    """Between one thread that makes things and one that works on them there is never a queue."""

    def __init__(self) -> None:
        self._changed = Condition()
        self._item: Item | None = None
        self._error: BaseException | None = None
        self._closed = False
        self.dropped = 0

    def put(self, item: Item) -> None:
        """Take the place of what is waiting."""
        with self._changed:
            self.dropped += self._item is not None
            self._item = item
            self._changed.notify()

    def close(self, error: BaseException | None = None) -> None:
        """Nothing more will come; ``error`` says why, if something went wrong."""
        with self._changed:
            self._closed, self._error = True, error
            self._changed.notify()

    def take(self, timeout: float | None = None) -> Item | None:
        """The newest thing, as soon as there is one; None after ``timeout`` seconds or when
        nothing more will come. Raises what the maker was closed with."""
        with self._changed:
            self._changed.wait_for(lambda: self._item is not None or self._closed, timeout)
            item, self._item = self._item, None
            if item is None and self._error is not None:
                raise self._error
            return item

    @property
    def finished(self) -> bool:
        """Whether all has been taken and nothing more will come."""
        with self._changed:
            return self._closed and self._item is None


def keep_newest(items: Iterable[Item]) -> Newest[Item]:
    """A slot that a thread of its own fills with ``items``."""
    slot: Newest[Item] = Newest()

    def fill() -> None:
        try:
            for item in items:
                if slot.finished:
                    return
                slot.put(item)
            slot.close()
        except BaseException as error:  # raised again in the thread that takes
            slot.close(error)

    Thread(target=fill, name="mien-newest", daemon=True).start()
    return slot
