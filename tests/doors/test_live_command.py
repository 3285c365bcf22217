"""``mien live`` as a user runs it: a recording in real time, known performers, several faces."""

from __future__ import annotations

import json
import os
import pty
import signal
import subprocess
import time
from importlib.resources import files
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from terminal import MIEN, error_line, mien, needs_landmarks, start

from clips import write_video
from mien.formats.pictures.sources import open_source
from mien.formats.takes.recording import read_recording
from mien.recipe import calibrate

SAMPLE = Path(str(files("mien") / "data" / "sample.mp4"))


@pytest.fixture(scope="module")
def pictures() -> list[np.ndarray]:
    """The first seconds of the clip that is shipped."""
    return [frame.image for frame in islice(open_source(SAMPLE), 48)]


@needs_landmarks
def test_a_known_performer_is_followed_from_the_first_frame(
    pictures: list[np.ndarray], tmp_path: Path
) -> None:
    take = write_video(tmp_path / "her.mp4", pictures)
    calibrate([take], tmp_path / "her.performer")
    done = mien(
        *("live", "--video", take, "--performer", "her.performer", "--record", "a.take", "--json"),
        cwd=tmp_path,
    )
    assert done.returncode == 0, done.stderr
    told = json.loads(done.stdout)
    assert told["following"] == told["frames"] > 3
    assert len(read_recording(tmp_path / "a.take")) == told["frames"]


@needs_landmarks
def test_of_several_faces_one_is_followed_and_it_is_said(
    pictures: list[np.ndarray], tmp_path: Path
) -> None:
    """The terminal's line tells it, so the command is given a terminal."""
    near = [image[:, 60:-60] for image in pictures]
    twice = [np.concatenate([image, image], axis=1) for image in near]
    pair = write_video(tmp_path / "pair.mp4", twice)
    ours, its = pty.openpty()
    running = subprocess.Popen(
        [MIEN, "live", "--video", pair, "--record", "a.take"],
        cwd=tmp_path,
        stdout=subprocess.DEVNULL,
        stderr=its,
    )
    os.close(its)
    told = b""
    while True:
        try:
            piece = os.read(ours, 4096)
        except OSError:  # how a terminal says that the other end has gone
            break
        told += piece
    assert running.wait(30) == 0
    assert b"following one of 2 faces" in told
    motion = read_recording(tmp_path / "a.take").translation[:, 0]
    assert np.ptp(motion) < 60.0, "it jumped from one to the other"


def test_a_recording_killed_hard_loses_at_most_a_second(tmp_path: Path) -> None:
    running = start(
        *("live", "--video", SAMPLE, "--capture", "snakes", "--record", "a.take"), cwd=tmp_path
    )
    file, size = tmp_path / "a.take", 0
    give_up = time.monotonic() + 60
    while size < 60_000 and time.monotonic() < give_up:
        time.sleep(0.1)
        size = file.stat().st_size if file.exists() else 0
    running.send_signal(signal.SIGKILL)
    killed = time.time()
    running.wait(10)
    running.communicate()
    take = read_recording(file)
    assert len(take) >= 20
    assert (np.diff(take.time) > 0).all()
    assert killed - file.stat().st_mtime < 1.0


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("--performer", "no.performer"), "no.performer: no such file"),
        (("--capture", "crystal ball"), "live there are landmarks, snakes, tracker"),
        (("--hear", "telepathy"), "no such protocol"),
    ],
)
def test_what_cannot_be_is_one_line(options: tuple[str, ...], told: str, tmp_path: Path) -> None:
    source = () if "--hear" in options else ("--video", SAMPLE)
    given = ("--record", "a.take", *source, *options)
    assert told in error_line(mien("live", *given, cwd=tmp_path))
    assert not list(tmp_path.iterdir())
