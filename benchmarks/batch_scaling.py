"""What a second worker is worth, what Dask costs over a plain loop, and what a worker needs.

    python benchmarks/batch_scaling.py --videos DIR [--takes 12] [--seconds 2] [--rounds 3]

Takes are cut from the videos of DIR and acted by the four characters: by one worker process, by
two, and in a plain loop inside one worker. Workers are warm, and the three go in turns; figures are
medians over the rounds. Beside each ratio of wall times stands the same by processor time, which
tells what a busy machine hides: ratio_cpu is what two workers would be worth on processors of
their own, overhead_cpu_pct counts the worker's own time.
"""

from __future__ import annotations

import argparse
import os
import statistics
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from batch_recovery import cut
from mien.batch import work
from mien.batch.cluster import client_of
from mien.batch.dispatch import Batch
from mien.batch.order import Order, roles
from mien.batch.store import Store
from mien.batch.takes import Take, find_takes
from report import show
from throughput import high_water


@dataclass(frozen=True)
class Spent:
    """What a batch took."""

    seconds: float
    cpu: float
    """Seconds of processor time, of all workers together."""


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--videos", type=Path, required=True, help="a folder of .mp4")
    parser.add_argument("--takes", type=int, default=12)
    parser.add_argument("--seconds", type=float, default=2.0, help="length of each take")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as room:
        cuts = Path(room, "cuts")
        cuts.mkdir()
        cut(options.videos, cuts, options.takes, options.seconds)
        figures = scaling(Path(room), find_takes([cuts]), options.rounds)
    minutes = options.takes * options.seconds / 60.0
    figures["cpu_s_per_minute"] = figures.pop("cpu_s") / minutes
    figures["capture_mb_per_minute"] = figures.pop("capture_mb") / minutes
    figures["result_mb_per_minute"] = figures.pop("result_mb") / minutes / 4.0
    load = os.getloadavg()[0]
    note = f"{os.cpu_count()} processors, load {load:.1f} at the end"
    show("batch_scaling", "Scaling of mien batch", figures | {"load": load}, options.json, note)


def scaling(room: Path, takes: list[Take], rounds: int) -> dict[str, float]:
    """Figures of ``rounds`` rounds over ``takes``."""
    order = Order(roles(()), looking={"method": "landmarks"})
    spent: dict[str, list[Spent]] = {"one": [], "two": [], "loop": []}
    with ExitStack() as stack:
        one = stack.enter_context(client_of(None, 1, room / "one"))
        two = stack.enter_context(client_of(None, 2, room / "two"))
        for number in range(-1, rounds):
            with folder(room, number, "one") as store:
                first = through_dask(one, store, order, takes)
            with folder(room, number, "two") as store:
                second = through_dask(two, store, order, takes)
            with folder(room, number, "loop") as store:
                third = one.submit(plain_loop, store, order, takes, pure=False).result()
                sizes = megabytes(store.captures), megabytes(store.results)
            if number >= 0:  # the round before the first warms the workers up
                for name, what in zip(spent, (first, second, third), strict=True):
                    spent[name].append(what)
        peaks = [*one.run(high_water).values(), *two.run(high_water).values()]
    walls = {name: statistics.median(s.seconds for s in each) for name, each in spent.items()}
    cpus = {name: statistics.median(s.cpu for s in each) for name, each in spent.items()}
    tasks = len(takes) * (2 + len(order.roles))
    return {
        "takes_per_minute_1": 60.0 * len(takes) / walls["one"],
        "takes_per_minute_2": 60.0 * len(takes) / walls["two"],
        "ratio": median_ratio(spent["one"], spent["two"], "seconds"),
        "ratio_cpu": 2.0 * median_ratio(spent["one"], spent["two"], "cpu"),
        "overhead_pct": 100.0 * (median_ratio(spent["one"], spent["loop"], "seconds") - 1.0),
        "overhead_cpu_pct": 100.0 * (median_ratio(spent["one"], spent["loop"], "cpu") - 1.0),
        "overhead_ms_per_task": 1e3 * (walls["one"] - walls["loop"]) / tasks,
        "worker_peak_mb": max(peaks),
        "cpu_s": cpus["loop"],
        "capture_mb": sizes[0],
        "result_mb": sizes[1],
    }


@contextmanager
def folder(room: Path, number: int, name: str) -> Iterator[Store]:
    """An empty store, opened."""
    store = Store(room / f"{name}{number}")
    with store.opened():
        yield store


def through_dask(client: Any, store: Store, order: Order, takes: list[Take]) -> Spent:
    """The batch as users run it."""
    before = sum(client.run(time.process_time).values())
    begin = time.perf_counter()
    fates = Batch(client, store, order, lambda done, expected: None)(takes)
    seconds = time.perf_counter() - begin
    assert not any(fate.error or fate.failed for fate in fates)
    return Spent(seconds, sum(client.run(time.process_time).values()) - before)


def plain_loop(store: Store, order: Order, takes: list[Take]) -> Spent:
    """The same work in one process, with nobody to hand it out."""
    begin, before = time.perf_counter(), time.process_time()
    for take in takes:
        digest = work.identify(take.path)
        work.look(store, take.path, digest, order)
        key = order.capture_key(digest)
        for role in order.roles:
            work.act(store, key, role, order)
            store.publish(order.result_key(key, role), take.name(digest))
    return Spent(time.perf_counter() - begin, time.process_time() - before)


def median_ratio(over: list[Spent], under: list[Spent], what: str) -> float:
    """Median over the rounds of one's cost over the other's."""
    pairs = zip(over, under, strict=True)
    return statistics.median(getattr(a, what) / getattr(b, what) for a, b in pairs)


def megabytes(folder: Path) -> float:
    """Of all files in a folder."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) / 2**20


if __name__ == "__main__":
    main()
