"""Follow a face now: stream it to other programs, or record it.

A camera, a recording in real time, or what a phone streams; out as VMC, Live Link Face,
iFacialMocap and OpenSeeFace, several at once.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING

from mien.cli.command import positive, tell
from mien.errors import InputError

if TYPE_CHECKING:
    from mien.capture.stepping import Stepper
    from mien.live.run import Live, Tally
    from mien.live.stage import Moment

OUTPUT_OPTIONS = ("vmc", "livelink", "ifacialmocap", "openseeface")
INPUT_OPTIONS = ("livelink", "vmc", "ifacialmocap")
_FOREVER = 1e9


def configure(parser: argparse.ArgumentParser) -> None:
    source = parser.add_mutually_exclusive_group()
    source.add_argument(
        "--camera", type=int, metavar="N", help="a camera of this machine (default: 0)"
    )
    source.add_argument("--video", metavar="FILE", help="a recording, played in real time")
    source.add_argument(
        "--hear",
        metavar="PROTOCOL[:PORT]",
        help=f"what others stream: {', '.join(INPUT_OPTIONS)}, on its usual port or another",
    )
    parser.add_argument(
        "--host", default="127.0.0.1", help="with --hear: the address to listen on (%(default)s)"
    )
    parser.add_argument("--wake", metavar="HOST", help="with --hear ifacialmocap: the phone")
    parser.add_argument(
        "--swap-sideways",
        action="store_true",
        help="with --hear livelink: exchange jaw and mouth left and right",
    )
    parser.add_argument(
        "--capture",
        metavar="NAME",
        help="how a face is followed: landmarks, snakes or tracker (default: landmarks, or snakes "
        "where the landmark networks are not installed)",
    )
    parser.add_argument(
        "--performer",
        type=Path,
        metavar="FILE.performer",
        help="what earlier takes told of the performer (see 'mien calibrate'); "
        "learnt in the first second otherwise",
    )
    parser.add_argument("--mirror", action="store_true", help="the pictures are mirrored")
    for name in OUTPUT_OPTIONS:
        parser.add_argument(
            f"--{name}",
            action="append",
            default=[],
            metavar="HOST[:PORT]",
            help=f"stream as {name} to this address; may be repeated",
        )
    parser.add_argument(
        "--record", type=Path, metavar="FILE.take", help="keep the performance, frame by frame"
    )
    parser.add_argument("--seconds", type=positive, help="stop then (default: Ctrl-C)")


def run(options: argparse.Namespace) -> None:
    from mien.live.outputs import Sender
    from mien.live.run import run as follow
    from mien.live.stage import Stage

    _check(options)
    senders = [Sender(*target) for target in _targets(options)]
    frames, stepper = _source(options)
    stage = Stage((), stepper, speak=bool(senders))
    try:
        tally = follow(
            frames,
            stage,
            outputs=senders,
            record=options.record,
            seconds=options.seconds,
            watch=_Watch(stepper) if sys.stderr.isatty() else None,
        )
    finally:
        for sender in senders:
            sender.close()
        if stepper is not None:
            stepper.close()
    _report(options, tally)


def _check(options: argparse.Namespace) -> None:
    if options.record is not None and options.record.suffix != ".take":
        raise InputError(f"--record {options.record}: a live recording is a .take file")
    if not _targets(options) and options.record is None:
        raise InputError(
            "nobody would be told: name a listener (--vmc 127.0.0.1), or a file (--record x.take)"
        )


def _targets(options: argparse.Namespace) -> list[tuple[str, str, int]]:
    """Protocol, host and port of every listener."""
    from mien.live.outputs import OUTPUTS, address

    targets = []
    for protocol in OUTPUT_OPTIONS:
        for text in getattr(options, protocol):
            try:
                targets.append((protocol, *address(text, OUTPUTS[protocol][1])))
            except ValueError as error:
                raise InputError(
                    f"--{protocol} {text}: expected an address like 127.0.0.1:39539"
                ) from error
    return targets


def _source(options: argparse.Namespace) -> tuple[Iterable[Live], Stepper | None]:
    """What gives frames, and what looks at them where they are pictures."""
    if options.hear is not None:
        return _receiver(options), None
    from mien.capture.detector import WITHOUT, installed
    from mien.capture.stepping import STEPPERS, available, meet
    from mien.formats.performer_file import read_performer
    from mien.formats.pictures.camera import open_camera
    from mien.formats.pictures.sources import open_source
    from mien.live.run import in_real_time

    capture = options.capture or available()[0]
    if capture not in STEPPERS:
        raise InputError(f"--capture {capture}: live there are {', '.join(STEPPERS)}")
    if options.capture is None and not installed():
        print(f"mien: {WITHOUT}", file=sys.stderr)
    frames: Iterable[Live]
    if options.video is not None:
        frames = in_real_time(open_source(options.video, mirror=options.mirror))
    else:
        frames = open_camera(options.camera or 0, options.seconds or _FOREVER, options.mirror)
    known = None if options.performer is None else read_performer(options.performer)
    return frames, meet(capture, known)


def _receiver(options: argparse.Namespace) -> Iterable[Live]:
    from mien.live.inputs import INPUTS, Receiver

    protocol, _, port = options.hear.partition(":")
    if protocol not in INPUTS:
        raise InputError(f"--hear {protocol}: no such protocol; there are {', '.join(INPUTS)}")
    if port and not port.isdecimal():
        raise InputError(f"--hear {options.hear}: '{port}' is no port")
    return Receiver(
        protocol,
        options.host,
        int(port or INPUTS[protocol][1]),
        swap_sideways=options.swap_sideways,
        wake=options.wake,
    )


class _Watch:
    """One line on the terminal, twice a second."""

    def __init__(self, stepper: Stepper | None) -> None:
        """``stepper`` is what looks at pictures; None where nobody does."""
        self._stepper = stepper
        self._told = 0.0

    def __call__(self, moment: Moment, tally: Tally) -> None:
        if monotonic() - self._told < 0.5:
            return
        self._told = monotonic()
        states = {
            "waiting": "looking for a face at rest",
            "following": "following",
            "lost": "the face is lost",
        }
        faces = self._stepper.trace.faces if self._stepper is not None else 1
        one = f" one of {faces} faces" if faces > 1 and moment.state == "following" else ""
        line = f"{states[moment.state]}{one}, {tally.late_ms(0.5):.0f} ms late, "
        print(f"\r{line + f'{tally.dropped} dropped':<70}", end="", file=sys.stderr, flush=True)


def _report(options: argparse.Namespace, tally: Tally) -> None:
    told = {
        "frames": tally.frames,
        "following": tally.following,
        "dropped": tally.dropped,
        "late_ms_p50": round(tally.late_ms(0.5), 2),
        "late_ms_p95": round(tally.late_ms(0.95), 2),
    }
    if sys.stderr.isatty():
        print(file=sys.stderr)
    files = [str(options.record)] if options.record and tally.recorded else []
    tell(
        options,
        {**told, "files": files},
        f"{tally.frames} frames, {tally.following} with the face, {tally.dropped} dropped; "
        f"late by {told['late_ms_p50']:g} ms (median), {told['late_ms_p95']:g} ms (95 %)",
        *files,
    )
