"""A batch: takes and an order in, a folder of results with its account and its report out."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from time import perf_counter
from typing import Any

from mien.batch.cluster import client_of
from mien.batch.dispatch import Batch, Told
from mien.batch.order import Order
from mien.batch.page import write_page
from mien.batch.record import Run, record, write_record
from mien.batch.store import Store
from mien.batch.takes import find_takes


def run_batch(
    takes: Sequence[str | Path],
    order: Order,
    folder: str | Path,
    *,
    scheduler: str | None = None,
    workers: int | None = None,
    told: Told = lambda done, expected: None,
) -> dict[str, Any]:
    """Let the characters of ``order`` act all ``takes``; the account of it, as batch.json has it.

    ``takes`` are files and folders of them; results go into ``folder``, where a batch that was
    interrupted goes on. ``scheduler`` is the address of a Dask scheduler whose workers see takes
    and folder under the same paths; without it ``workers`` processes of this machine do the work
    (a script that calls this needs its ``if __name__ == "__main__"``). ``told`` is called with the
    number of (take, character) pairs done, and of all. A take that fails stops no other: the
    account says why. Raises InputError, OutputError, MissingExtraError.
    """
    found = find_takes(takes)
    store = Store(Path(folder).resolve())
    begin, started = perf_counter(), datetime.now(UTC).isoformat(timespec="seconds")
    with store.opened(), client_of(scheduler, workers, store.workers) as client:
        dispatch = Batch(client, store, order, told)
        fates = dispatch(found)
        run = Run(started, round(perf_counter() - begin, 3), workers_of(client), dispatch.count)
        account = record(fates, order, store, run)
        write_record(account, store)
        write_page(account, store)
    return account


def workers_of(client: Any) -> int:
    """How many workers there are now."""
    return len(client.scheduler_info(n_workers=-1)["workers"])
