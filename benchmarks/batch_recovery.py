"""A batch that is killed twice and goes on gives what an undisturbed one gives, and so does another
scheduler.

    python benchmarks/batch_recovery.py --videos DIR [--takes 60] [--seconds 1] [--json]

Takes are cut from the videos of DIR; two bad files stand among them. Three batches of them by the
four characters: undisturbed, on one worker; killed twice with SIGKILL and resumed, on two; and on a
scheduler with two workers that are started by hand. Every file of the results is compared.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import av

from report import show

MIEN = Path(sys.executable).with_name("mien")
KEPT = ("captures", "results", "takes")


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--videos", type=Path, required=True, help="a folder of .mp4")
    parser.add_argument("--takes", type=int, default=60, help="two of them bad")
    parser.add_argument("--seconds", type=float, default=1.0, help="length of each take")
    parser.add_argument("--keep", type=Path, help="a folder in which everything stays")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        room = options.keep or Path(temporary)
        figures = recovery(room, options.videos, options.takes, options.seconds)
    show("batch_recovery", f"{options.takes} takes by four characters", figures, options.json)


def recovery(room: Path, videos: Path, count: int, seconds: float) -> dict[str, float]:
    """What came of three batches of ``count`` takes in ``room``."""
    takes = room / "cuts"
    if not takes.exists():
        takes.mkdir(parents=True)
        cut(videos, takes, count - 2, seconds)
        spoil(takes)
    plain = undisturbed(takes, room / "plain")
    stops, killed = disturbed(takes, room / "killed", (count - 2) * 4)
    with scheduler() as address:
        called = finish(takes, room / "called", "--scheduler", address)
    wanted = contents(room / "plain")
    counts = killed["run"]["count"]
    last = stops[-1]
    return {
        "takes": float(count),
        "results": float(len(list((room / "plain/results").iterdir()))),
        "files": float(len(wanted)),
        "files_that_differ_after_kills": differing(wanted, contents(room / "killed")),
        "files_that_differ_elsewhere": differing(wanted, contents(room / "called")),
        "results_at_first_kill": float(len(stops[0]["results"])),
        "results_at_second_kill": float(len(last["results"])),
        "done_again": float(again(last, room / "killed") + again(stops[0], room / "killed")),
        "captures_found_minus_kept": float(counts["captures_found"] - len(last["captures"])),
        "results_found_minus_kept": float(counts["acts_found"] - len(last["results"])),
        "orphans": float(orphans(room / "killed") + orphans(room / "called")),
        "takes_named_as_bad": float(sum("error" in take for take in killed["takes"])),
        "workers_called": float(called["run"]["workers"]),
        "seconds_undisturbed": plain["run"]["seconds"],
        "seconds_called": called["run"]["seconds"],
    }


def cut(videos: Path, room: Path, count: int, seconds: float) -> None:
    """``count`` takes of ``seconds`` each, from all videos in turns."""
    sources = sorted(videos.glob("*.mp4"))
    done = 0
    for part in range(1000):
        before = done
        for source in sources:
            made = room / f"{source.stem}_{part:02d}.mp4"
            if done < count and cut_one(source, made, part, seconds):
                done += 1
        if done in (count, before):
            return


def cut_one(source: Path, path: Path, part: int, seconds: float) -> bool:
    """Write the ``part``-th stretch of a video, if it is that long."""
    with av.open(str(source)) as video:
        stream = video.streams.video[0]
        length = max(2, round(seconds * float(stream.average_rate)))
        first = part * length
        if first + length > stream.frames:
            return False
        with av.open(str(path), "w") as film:
            made = film.add_stream("libx264", rate=stream.average_rate, options={"crf": "18"})
            made.width, made.height, made.pix_fmt = stream.width, stream.height, "yuv420p"
            for number, frame in enumerate(video.decode(stream)):
                if number >= first + length:
                    break
                if number >= first:
                    picture = av.VideoFrame.from_ndarray(frame.to_ndarray(format="rgb24"))
                    picture.pts = number - first
                    film.mux(made.encode(picture))
            film.mux(made.encode())
    return True


def spoil(takes: Path) -> None:
    """Put a file that is no video and one that was cut off among the takes."""
    whole = sorted(takes.iterdir())[0].read_bytes()
    (takes / "letter.mp4").write_text("This is not a video.\n")
    (takes / "torn.mp4").write_bytes(whole[: len(whole) // 2])


def batch(takes: Path, out: Path, *more: str) -> subprocess.Popen[str]:
    """Start ``mien batch``."""
    command = [str(MIEN), "batch", str(takes), "-o", str(out), *more]
    return subprocess.Popen(command, stderr=subprocess.PIPE, text=True)


def finish(takes: Path, out: Path, *more: str) -> dict[str, Any]:
    """Run a batch to its end; its account."""
    process = batch(takes, out, *more)
    _, said = process.communicate()
    assert process.returncode == 1, said  # the two bad files
    return dict(json.loads((out / "batch.json").read_text()))


def undisturbed(takes: Path, out: Path) -> dict[str, Any]:
    """A batch that nobody stops."""
    return finish(takes, out, "--workers", "1")


def disturbed(takes: Path, out: Path, pairs: int) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """A batch that is killed when a third and when two thirds are done, and resumed: what was kept
    at each kill, and the account at the end."""
    stops = []
    for share in (1 / 3, 2 / 3):
        process = batch(takes, out, "--workers", "2")
        while len(whole(out / "results")) < share * pairs:
            assert process.poll() is None, "it ended before it was killed"
            time.sleep(0.02)
        process.send_signal(signal.SIGKILL)
        process.wait()
        time.sleep(2.0)  # its workers notice within moments; what they made until then is kept
        stops.append({kind: whole(out / kind) for kind in ("captures", "results")})
    return stops, finish(takes, out, "--workers", "2")


@contextmanager
def scheduler() -> Iterator[str]:
    """A scheduler and two workers, as somebody would start them by hand; its address."""
    with tempfile.TemporaryDirectory() as room:
        told = Path(room, "scheduler.json")
        dask = [sys.executable, "-m", "dask"]
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": room}
        head = [*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard"]
        running = [subprocess.Popen([*head, "--scheduler-file", told], **quiet)]
        try:
            while not told.exists():
                time.sleep(0.1)
            address = str(json.loads(told.read_text())["address"])
            hand = [*dask, "worker", address, "--nthreads", "1", "--no-dashboard"]
            running += [subprocess.Popen(hand, **quiet) for _ in range(2)]
            yield address
        finally:
            for process in reversed(running):
                process.terminate()
                process.wait()


def whole(folder: Path) -> dict[str, tuple[int, int]]:
    """What is finished in ``folder``: its inode and time by name."""
    if not folder.exists():
        return {}
    found = {}
    for entry in folder.iterdir():
        if not entry.name.startswith("."):
            state = entry.stat()
            found[entry.name] = (state.st_ino, state.st_mtime_ns)
    return found


def again(stop: dict[str, Any], out: Path) -> int:
    """How much of what was done at a stop has been made anew since."""
    return sum(
        whole(out / kind).get(name) != state for kind in stop for name, state in stop[kind].items()
    )


def contents(out: Path) -> dict[str, str]:
    """Digest of every file a batch made, but for its account and report, which tell times."""
    return {
        path.relative_to(out).as_posix(): hashlib.sha256(path.read_bytes()).hexdigest()
        for kind in KEPT
        for path in sorted((out / kind).rglob("*"))
        if path.is_file()
    }


def differing(wanted: dict[str, str], found: dict[str, str]) -> float:
    """Files that are not the same, or in one of the two only."""
    return float(len(wanted.items() ^ found.items()))


def orphans(out: Path) -> int:
    """Files and folders that no batch meant to leave."""
    known = {*KEPT, "batch.json", "index.html"}
    hidden = sum(path.name.startswith(".") for path in out.rglob("*"))
    return hidden + sum(path.name not in known for path in out.iterdir())


if __name__ == "__main__":
    main()
