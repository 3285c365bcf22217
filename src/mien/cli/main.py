"""The command line: picks a command, runs it, and says in one line what went wrong."""

from __future__ import annotations

import argparse
import json
import os
import sys
import traceback
from collections.abc import Sequence
from importlib import metadata

from mien.cli import (
    animate,
    batch,
    calibrate,
    capture,
    character,
    databank,
    demo,
    doctor,
    interruption,
    live,
    report,
    scan,
    studio,
)
from mien.cli.command import Command
from mien.errors import MienError

COMMANDS: dict[str, Command] = {
    "animate": animate,
    "capture": capture,
    "calibrate": calibrate,
    "batch": batch,
    "report": report,
    "live": live,
    "studio": studio,
    "character": character,
    "scan": scan,
    "databank": databank,
    "demo": demo,
    "doctor": doctor,
}

PLAIN_ERROR = 1


def run(arguments: Sequence[str] | None = None) -> int:
    """Entry point of ``mien``. Exit codes: 0, 1 (a plain error), 2 (usage), 130 (interrupted),
    143 (told to end)."""
    interruption.listen()
    # A second thread gains little on products of this size and is waited for on a busy machine;
    # with one, results do not depend on how many cores there are.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    options = _parser().parse_args(arguments)
    try:
        COMMANDS[options.command].run(options)
        sys.stdout.flush()
    except BaseException as error:
        return _leave(error, options)
    return 0


def _leave(error: BaseException, options: argparse.Namespace) -> int:
    """Say what is to be said of ``error``; the exit code. What nobody expects is raised again."""
    signalled = interruption.exit_code(error)
    if signalled == interruption.INTERRUPTED:
        left = getattr(COMMANDS[options.command], "INTERRUPTED", "nothing was left behind")
        print(f"mien: interrupted; {left}", file=sys.stderr)
    if signalled is not None:
        return signalled
    if isinstance(error, BrokenPipeError):
        # Whoever read the output has gone (| head): nothing is wrong, and nobody to tell.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    if not isinstance(error, MienError):
        raise error
    if options.verbose:
        traceback.print_exc()
    if options.json:
        print(json.dumps({"command": options.command, "error": str(error)}))
    print(f"mien: {error}", file=sys.stderr)
    return PLAIN_ERROR


def _parser() -> argparse.ArgumentParser:
    common = argparse.ArgumentParser(add_help=False)
    common.add_argument(
        "--json", action="store_true", help="print one machine-readable result instead of text"
    )
    common.add_argument("-v", "--verbose", action="store_true", help="tell more, also of errors")
    parser = argparse.ArgumentParser(
        prog="mien",
        description="Any performance drives any face.",
        epilog="'mien COMMAND --help' tells more. Try 'mien demo' first.",
    )
    parser.add_argument("--version", action="version", version=f"mien {metadata.version('mien')}")
    commands = parser.add_subparsers(dest="command", required=True, metavar="COMMAND")
    for name, command in COMMANDS.items():
        summary = (command.__doc__ or "").splitlines()[0]
        command.configure(
            commands.add_parser(name, help=summary, description=summary, parents=[common])
        )
    return parser
