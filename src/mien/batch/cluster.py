"""Who does the work: processes of this machine, or a scheduler that has workers of its own."""

from __future__ import annotations

import logging
import os
import signal
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from mien.errors import InputError, MissingExtraError

NEED = 2**30
"""Bytes that a worker should have: about twice what capturing a take of some minutes takes."""
PATIENCE = 10
"""Seconds to wait for a scheduler to answer."""
_ATTEMPTS = 2
"""Times that workers are started where one dies before it has begun."""
_SETTINGS = {
    # A task that kills its worker, by its memory or otherwise, is tried once more and no oftener.
    "distributed.scheduler.allowed-failures": 1,
    # A machine that is overworked answers late; that is no reason to give it up.
    "distributed.comm.timeouts.connect": "120s",
    "distributed.comm.timeouts.tcp": "300s",
    "distributed.nanny.pre-spawn-environ.NUMBA_NUM_THREADS": 1,
}


@contextmanager
def client_of(scheduler: str | None, workers: int | None, room: Path) -> Iterator[Any]:
    """A Dask client: of the ``scheduler`` at that address, or of ``workers`` processes here (as
    many as processors and memory allow), which keep things of their own in ``room``.

    Raises MissingExtraError, InputError where nobody answers at the address or no process can be
    started.
    """
    try:
        import dask
        import distributed
    except ImportError as error:
        raise MissingExtraError("mien batch", "batch") from error
    # What happens to workers is told in the report; their logs would run through the progress.
    logging.getLogger("distributed").setLevel(logging.CRITICAL)
    with dask.config.set(_SETTINGS), ExitStack() as stack:
        with _deaf():
            if scheduler is not None:
                client = stack.enter_context(_called(scheduler))
            else:
                cluster = stack.enter_context(_started(workers or default_workers(), room))
                client = stack.enter_context(distributed.Client(cluster))
        yield client


def default_workers() -> int:
    """One for each processor, as far as there is memory for them."""
    return max(1, min(len(os.sched_getaffinity(0)), memory() // NEED))


def memory() -> int:
    """Bytes that this process and its children may use, limits of containers included."""
    from distributed.system import MEMORY_LIMIT

    return int(MEMORY_LIMIT)


def _started(count: int, room: Path, attempts: int = _ATTEMPTS) -> Any:
    from distributed import LocalCluster

    try:
        return LocalCluster(
            n_workers=count,
            threads_per_worker=1,
            memory_limit=memory() // count,
            dashboard_address="127.0.0.1:0",
            local_directory=room,
            silence_logs=logging.CRITICAL,
        )
    except RuntimeError as error:
        if attempts > 1:
            return _started(count, room, attempts - 1)
        raise InputError(
            f"--workers {count}: they die as they begin; give fewer, or more memory"
        ) from error


def _called(address: str) -> Any:
    from distributed import Client

    try:
        return Client(address, timeout=PATIENCE)
    except (OSError, ValueError) as error:
        raise InputError(
            f"--scheduler {address}: nobody answers there; start one with 'dask scheduler' and "
            "name it as it does: tcp://HOST:PORT"
        ) from error


@contextmanager
def _deaf() -> Iterator[None]:
    """Processes and threads that are started here never hear Ctrl-C, which a terminal sends to all
    of them: only who started them does, afterwards."""
    if sys.platform == "win32":
        yield
        return
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
