"""How many tasks a second one Dask scheduler deals out: what bounds the number of workers.

    python benchmarks/batch_scheduler.py [--tasks 100000] [--workers 2] [--threads 8] [--json]

The dispatcher of ``mien batch`` runs a library of takes whose tasks do nothing, against a scheduler
and workers in processes of their own. Processor time tells what scheduler and client need for a
task, however busy the machine; from that docs/scale.md models a thousand workers.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import batch_scheduler as here
from mien.batch import dispatch
from mien.batch.cluster import client_of
from mien.batch.order import Order, Role
from mien.batch.store import Store
from mien.batch.takes import Take
from report import show

CAST = ("man", "woman", "monkey", "toy")
STEPS = 2 + len(CAST)
"""Tasks of a take: identify, look, and act for each character."""


class Nowhere(Store):
    """A store in which nothing is kept."""

    def publish(self, key: str, take: str) -> None:
        """Nothing was made, so nothing is shown."""


def identify(take: str) -> str:
    """A digest at once."""
    return take


def look(store: Store, take: str, digest: str, order: Order) -> None:
    """A capture at once."""


def act(store: Store, capture_key: str, role: Role, order: Order) -> None:
    """A result at once."""


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--tasks", type=int, default=100_000)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--threads", type=int, default=8, help="of each worker")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    for name in ("identify", "look", "act"):
        setattr(dispatch.work, name, getattr(here, name))
    takes = [Take(f"/take{i}", f"take{i}", False) for i in range(options.tasks // STEPS)]
    order = Order(tuple(Role(name, name, name) for name in CAST))
    with tempfile.TemporaryDirectory() as room:
        store = here.Nowhere(Path(room))
        for kept in (store.captures, store.results):
            kept.mkdir()
        with cluster(options.workers, options.threads) as (address, scheduler):
            figures = run(address, scheduler, store, order, takes)
    show("batch_scheduler", f"{len(takes) * STEPS} tiny tasks", figures, options.json)


def run(
    address: str, scheduler: int, store: Store, order: Order, takes: list[Take]
) -> dict[str, float]:
    """What the tasks of ``takes`` cost."""
    tasks = len(takes) * STEPS
    with client_of(address, None, store.root) as client:
        own, theirs = time.process_time(), cpu(scheduler)
        begin = time.perf_counter()
        batch = dispatch.Batch(client, store, order, lambda done, expected: None)
        fates = batch(takes)
        seconds = time.perf_counter() - begin
        own, theirs = time.process_time() - own, cpu(scheduler) - theirs
    assert batch.count.acted == len(takes) * len(CAST)
    assert not any(fate.error or fate.failed for fate in fates)
    return {
        "tasks": float(tasks),
        "tasks_per_second": tasks / seconds,
        "scheduler_cpu_ms": 1e3 * theirs / tasks,
        "client_cpu_ms": 1e3 * own / tasks,
        "tasks_per_second_cpu": tasks / max(theirs, own),
        "scheduler_peak_mb": peak(scheduler),
        "load": os.getloadavg()[0],
    }


@contextmanager
def cluster(workers: int, threads: int) -> Iterator[tuple[str, int]]:
    """A scheduler and workers, each a process; its address and its process id."""
    with tempfile.TemporaryDirectory() as room:
        told = Path(room, "address")
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": room}
        paths = [str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")]
        quiet["env"] = os.environ | {
            "PYTHONPATH": os.pathsep.join(filter(None, paths)),
            "DASK_DISTRIBUTED__COMM__TIMEOUTS__TCP": "300s",
        }
        dask = [sys.executable, "-m", "dask"]
        head = [*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
        running = [subprocess.Popen([*head, "--scheduler-file", told], **quiet)]
        try:
            while not told.exists():
                time.sleep(0.1)
            hand = [*dask, "worker", "--scheduler-file", told, "--nthreads", str(threads)]
            hand += ["--no-dashboard", "--no-nanny"]
            running += [subprocess.Popen(hand, **quiet) for _ in range(workers)]
            yield address_in(told), running[0].pid
        finally:
            for process in reversed(running):
                process.terminate()
                process.wait()


def address_in(told: Path) -> str:
    """What a scheduler says of itself."""
    return str(json.loads(told.read_text())["address"])


def cpu(process: int) -> float:
    """Seconds of processor time a process has used."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def peak(process: int) -> float:
    """MB that a process held at most."""
    status = Path(f"/proc/{process}/status").read_text()
    return int(status.split("VmHWM:")[1].split()[0]) / 1024.0


if __name__ == "__main__":
    main()
