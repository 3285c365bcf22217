"""A batch from its takes to its results: who is sent what, and what became of it.

A take is identified by its content, captured once and acted by every character. What the store
holds already is not sent out; so a batch that was interrupted goes on where it stopped.
"""

from __future__ import annotations

import uuid
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from mien.batch import work
from mien.batch.order import Order, Role
from mien.batch.store import Store
from mien.batch.takes import Take
from mien.errors import InputError

Told = Callable[[int, int], None]
"""Told how many pairs are done, and how many there are."""

_RETRIES = 1
_IDENTIFY, _LOOK, _ACT = range(3)
"""Priorities: what was begun is finished first, so that results come early."""


@dataclass(slots=True)
class Fate:
    """What became of a take."""

    take: Take
    digest: str = ""
    error: str = ""
    """Why it could not be captured; empty where it could."""
    failed: dict[str, str] = field(default_factory=dict)
    """Why a character could not act it."""

    @property
    def name(self) -> str:
        """What its results are called."""
        return self.take.name(self.digest)


@dataclass(slots=True)
class Count:
    """How much was computed in this run, and how much found in the store."""

    captured: int = 0
    captures_found: int = 0
    acted: int = 0
    acts_found: int = 0


@dataclass(frozen=True, slots=True)
class _Sent:
    """What is done when a task comes back."""

    then: Callable[[Any], None]
    otherwise: Callable[[str], None]


class Batch:
    """One run over some takes."""

    def __init__(self, client: Any, store: Store, order: Order, told: Told) -> None:
        from distributed import as_completed

        self.count = Count()
        self._client, self._store, self._order, self._told = client, store, order, told
        self._captures = {path.name for path in store.captures.iterdir()}
        self._results = {path.name for path in store.results.iterdir()}
        self._first: dict[str, Fate] = {}
        self._sent: dict[str, _Sent] = {}
        self._arriving = as_completed()
        self._done = self._all = 0

    def __call__(self, takes: Sequence[Take]) -> list[Fate]:
        """Do it; the fates of ``takes``, in their order. Raises InputError where the scheduler
        goes away."""
        fates = [Fate(take) for take in takes]
        self._all = len(takes) * len(self._order.roles)
        self._tell(0)
        for fate in fates:
            self._identify(fate)
        for future in self._arriving:
            sent = self._sent.pop(future.key)
            error = _error(future)
            if error:
                sent.otherwise(error)
            else:
                sent.then(future.result())
        for fate in fates:
            self._share(fate)
        return fates

    def _identify(self, fate: Fate) -> None:
        def then(digest: str) -> None:
            fate.digest = digest
            if self._first.setdefault(digest, fate) is fate:
                self._look(fate)
            else:
                self._tell(len(self._order.roles))

        sent = _Sent(then, partial(self._lose, fate))
        self._send(_IDENTIFY, sent, work.identify, fate.take.path)

    def _look(self, fate: Fate) -> None:
        key = self._order.capture_key(fate.digest)
        if key in self._captures:
            self.count.captures_found += 1
            self._act(fate, key)
            return

        def then(_: None) -> None:
            self.count.captured += 1
            self._act(fate, key)

        arguments = self._store, fate.take.path, fate.digest, self._order
        self._send(_LOOK, _Sent(then, partial(self._lose, fate)), work.look, *arguments)

    def _act(self, fate: Fate, capture_key: str) -> None:
        for role in self._order.roles:
            key = self._order.result_key(capture_key, role)
            if key in self._results:
                self.count.acts_found += 1
                self._keep(fate, key)
            else:
                sent = _Sent(partial(self._acted, fate, key), partial(self._miss, fate, role))
                self._send(_ACT, sent, work.act, self._store, capture_key, role, self._order)

    def _acted(self, fate: Fate, key: str, _: None) -> None:
        self.count.acted += 1
        self._keep(fate, key)

    def _keep(self, fate: Fate, key: str) -> None:
        self._store.publish(key, fate.name)
        self._tell(1)

    def _miss(self, fate: Fate, role: Role, error: str) -> None:
        fate.failed[role.name] = error
        self._tell(1)

    def _lose(self, fate: Fate, error: str) -> None:
        fate.error = error
        self._tell(len(self._order.roles))

    def _share(self, fate: Fate) -> None:
        """A take of the same content as an earlier one has the same results."""
        first = self._first.get(fate.digest, fate)
        if first is fate:
            return
        fate.error, fate.failed = first.error, first.failed
        for key in self._order.result_keys(fate.digest):
            if (self._store.results / key).is_dir():
                self._store.publish(key, fate.name)

    def _send(self, priority: int, sent: _Sent, task: Any, *arguments: Any) -> None:
        key = f"{task.__name__}-{uuid.uuid4().hex}"
        self._sent[key] = sent
        future = self._client.submit(
            task, *arguments, key=key, retries=_RETRIES, priority=priority, pure=False
        )
        self._arriving.add(future)

    def _tell(self, more: int) -> None:
        self._done += more
        self._told(self._done, self._all)


def _error(future: Any) -> str:
    """Why a task failed, empty where it did not."""
    if future.status == "finished":
        return ""
    if future.status != "error":
        raise InputError(
            "the scheduler went away; what is done is kept, and the same command goes on from there"
        )
    error = future.exception()
    if type(error).__name__ == "KilledWorker":
        return "two workers died of it, most likely for want of memory; use fewer, or cut the take"
    if isinstance(error, work.TaskError):
        return str(error)
    # Dask tells in several lines that something could not be sent, and what it was in the cause.
    told = error.__cause__ or error
    return f"{type(told).__name__}: {str(told).strip().partition(chr(10))[0]}"
