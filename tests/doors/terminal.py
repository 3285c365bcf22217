"""The installed command, as a user runs it."""

from __future__ import annotations

import importlib.util
import signal
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

FRAMES = 12
"""Of the take that tests are given."""
WINK = slice(7, 10)
"""Its frames in which the left eye is shut."""

MIEN = Path(sys.executable).with_name("mien")

needs_landmarks = pytest.mark.skipif(
    importlib.util.find_spec("mediapipe") is None, reason="needs the extra 'landmarks'"
)


def mien(
    *arguments: object, cwd: Path, limit: Callable[[], None] | None = None
) -> subprocess.CompletedProcess[str]:
    """Run ``mien`` to its end, with nobody watching the terminal."""
    return subprocess.run(
        [MIEN, *map(str, arguments)],
        cwd=cwd,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
        preexec_fn=limit,
    )


def start(*arguments: object, cwd: Path) -> subprocess.Popen[str]:
    """Run ``mien`` and go on; it hears Ctrl-C even where a background shell is told not to."""
    return subprocess.Popen(
        [MIEN, *map(str, arguments)],
        cwd=cwd,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
    )


def error_line(done: subprocess.CompletedProcess[str]) -> str:
    """The one line that tells of a plain error, and nothing else was said."""
    assert done.returncode == 1, done.stderr
    assert done.stdout == ""
    lines = done.stderr.splitlines()
    assert len(lines) == 1, done.stderr
    assert lines[0].startswith("mien: ")
    return lines[0]
