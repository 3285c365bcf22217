"""How far a command is: a bar on a terminal, nothing in a pipe."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from mien.cli.interruption import check

Progress = Callable[[int, int | None], None]


@contextmanager
def progress(what: str, rate: str = "") -> Iterator[Progress]:
    """Show a bar for ``what`` on standard error where somebody watches, and give what to call with
    the number done and the number expected (None: unknown). ``rate`` is what to call the things
    of which so and so many are done a minute."""
    if not sys.stderr.isatty():
        yield lambda done, expected: check()
        return
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bars

    columns = [TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn()]
    if rate:
        columns.append(TextColumn("{task.fields[rate]}"))
    with Bars(
        *columns, TimeRemainingColumn(), console=Console(stderr=True), transient=True
    ) as bars:
        task = bars.add_task(what, total=None, rate="")

        def show(done: int, expected: int | None) -> None:
            check()
            speed = bars.tasks[0].speed
            pace = f"{60.0 * speed:.0f} {rate} a minute" if speed else ""
            bars.update(task, completed=done, total=expected, rate=pace)

        yield show
