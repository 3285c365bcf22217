"""Ctrl-C that cannot get lost.

Python raises KeyboardInterrupt wherever it happens to be, also inside callbacks of native code,
which print it and go on, or in an import, which wraps it in an error of its own. So the signal is
remembered too, and asked about between frames, before results are left standing and at the end.
"""

from __future__ import annotations

import signal
from typing import NoReturn

INTERRUPTED, TERMINATED = 130, 143

_seen: list[int] = []


def listen() -> None:
    """Remember Ctrl-C besides raising it; treat being told to end alike, with its own exit code."""
    signal.signal(signal.SIGINT, _interrupted)
    signal.signal(signal.SIGTERM, _terminated)


def check() -> None:
    """Raise what was signalled, if it was swallowed on its way."""
    if signal.SIGTERM in _seen:
        raise SystemExit(TERMINATED)
    if _seen:
        raise KeyboardInterrupt


def exit_code(error: BaseException) -> int | None:
    """How to leave after ``error``: by the signal it came of, None if it came of none."""
    if signal.SIGTERM in _seen:
        return TERMINATED
    return INTERRUPTED if _seen or isinstance(error, KeyboardInterrupt) else None


def _interrupted(signum: int, frame: object) -> NoReturn:
    _seen.append(signum)
    raise KeyboardInterrupt


def _terminated(signum: int, frame: object) -> NoReturn:
    _seen.append(signum)
    raise SystemExit(TERMINATED)
