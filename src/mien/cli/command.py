"""What every command is, and the option values several of them read."""

from __future__ import annotations

import argparse
import json
import math
import sys
from typing import Any, Protocol


class Command(Protocol):
    """A module of this package; the first line of its docstring is its help."""

    __doc__: str | None

    def configure(self, parser: argparse.ArgumentParser, /) -> None:
        """Add its options. Imports nothing heavy: ``mien --help`` calls this for all."""

    def run(self, options: argparse.Namespace, /) -> None:
        """Do it. Raises MienError."""


def positive(text: str) -> float:
    """A finite number above zero."""
    value = not_negative(text)
    if value == 0.0:
        raise argparse.ArgumentTypeError(f"{text} is not above 0")
    return value


def not_negative(text: str) -> float:
    """A finite number, zero or above."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not (math.isfinite(value) and value >= 0.0):
        raise argparse.ArgumentTypeError(f"'{text}' is not a number from 0 up")
    return value


def span(text: str) -> tuple[float, float]:
    """ "2.5-3" as (2.5, 3.0); "2.5" as half a second from there on."""
    first, dash, last = text.partition("-")
    begin = not_negative(first)
    end = not_negative(last) if dash else begin + 0.5
    if end <= begin:
        raise argparse.ArgumentTypeError(f"'{text}' ends before it begins")
    return begin, end


def tell(options: argparse.Namespace, result: dict[str, Any], *lines: str) -> None:
    """Print a command's result: ``result`` with --json, ``lines`` otherwise."""
    if options.json:
        print(json.dumps({"command": options.command, **result}))
        return
    for line in lines:
        print(line)


def remark(options: argparse.Namespace, line: str) -> None:
    """Say what is being done, to those who asked with -v."""
    if options.verbose:
        print(f"mien: {line}", file=sys.stderr)
