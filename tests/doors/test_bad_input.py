"""What is wrong is said in one line, the exit code is 1, and nothing is left behind."""

from __future__ import annotations

import json
import resource
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from terminal import error_line, mien, needs_landmarks, start

from clips import noise, write_video
from mien.cli import interruption
from mien.cli.main import COMMANDS, run


def test_a_missing_file(tmp_path: Path) -> None:
    said = error_line(mien("animate", "absent.mp4", "-o", "out", cwd=tmp_path))
    assert said == "mien: absent.mp4: no such file"
    assert not list(tmp_path.iterdir())


def test_an_unknown_character_is_told_before_the_work(take: Path, tmp_path: Path) -> None:
    said = error_line(mien("animate", take, "-c", "nobody", "-o", "out", cwd=tmp_path))
    assert "nobody" in said
    assert "monkey" in said
    assert not list(tmp_path.iterdir())


@needs_landmarks
@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("text", "not a video"),
        ("empty", "not a video"),
        ("cut", "cut off"),
        ("one frame", "at least two"),
        ("no face", "no face"),
    ],
)
def test_a_take_that_cannot_be_used(tmp_path: Path, content: str, told: str) -> None:
    path = tmp_path / "take.mp4"
    if content == "text":
        path.write_text("dear diary\n" * 100)
    elif content == "empty":
        path.touch()
    elif content == "cut":
        whole = write_video(path, noise(20), options={"movflags": "faststart"}).read_bytes()
        path.write_bytes(whole[: len(whole) // 2])
    else:
        write_video(path, noise(1 if content == "one frame" else 5))
    said = error_line(mien("animate", path, "-o", "out", cwd=tmp_path))
    assert told in said
    assert "take.mp4" in said
    assert [found.name for found in tmp_path.iterdir()] == ["take.mp4"]


@needs_landmarks
def test_a_capture_without_a_face(tmp_path: Path) -> None:
    write_video(tmp_path / "take.mp4", noise(5))
    assert "no face" in error_line(mien("capture", "take.mp4", cwd=tmp_path))
    assert [found.name for found in tmp_path.iterdir()] == ["take.mp4"]


def test_a_result_never_takes_the_place_of_its_take(captured: Path, tmp_path: Path) -> None:
    take = tmp_path / "take.csv"
    mien("capture", captured, "-o", take, cwd=tmp_path)
    before = take.read_bytes()
    line = error_line(mien("animate", take, "-c", "man", "-o", "take.csv", cwd=tmp_path))
    assert "take.csv" in line
    assert take.read_bytes() == before


def test_ctrl_c_that_native_code_swallowed_is_raised_later(monkeypatch) -> None:
    monkeypatch.setattr(interruption, "_seen", [])
    interruption.check()
    with pytest.raises(KeyboardInterrupt):
        interruption._interrupted(signal.SIGINT, None)
    with pytest.raises(KeyboardInterrupt):
        interruption.check()


@pytest.mark.parametrize(
    ("signum", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)], ids=["Ctrl-C", "kill"]
)
def test_an_interruption_is_known_in_another_error_s_clothes(
    signum: int, code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def wrap(options: object) -> None:
        """As Python 3.11 does with what is raised while a class is made."""
        try:
            signal.raise_signal(signum)
        except BaseException as error:
            raise RuntimeError("Error calling __set_name__") from error

    monkeypatch.setattr(interruption, "_seen", [])
    monkeypatch.setattr(COMMANDS["doctor"], "run", wrap)
    before = signal.getsignal(signal.SIGINT), signal.getsignal(signal.SIGTERM)
    try:
        assert run(["doctor"]) == code
    finally:
        signal.signal(signal.SIGINT, before[0])
        signal.signal(signal.SIGTERM, before[1])
    assert len(capsys.readouterr().err.splitlines()) <= 1


def test_an_unwritable_folder_is_told_before_the_work(take: Path, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("not a folder")
    said = error_line(mien("animate", take, "-o", "file/out", cwd=tmp_path))
    assert "cannot write into file/out" in said
    assert (tmp_path / "file").read_text() == "not a folder"


@needs_landmarks
def test_a_disk_that_fills_up(captured: Path, tmp_path: Path) -> None:
    def small() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (500_000, 500_000))

    done = mien("animate", captured, "-o", "out", cwd=tmp_path, limit=small)
    assert "cannot write out/man.glb" in error_line(done)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("options", "told"),
    [
        (("-o", "man.fbx", "-c", "man"), "man.fbx"),
        (("-c", "man", "-c", "man"), "twice"),
        (("-f", "fbx"), "fbx"),
        (("--start", "3", "--end", "2"), "--start"),
        (("--rate", "25"), "--rate 25"),
        (("--capture", "telepathy"), "telepathy"),
    ],
)
def test_options_that_make_no_sense(
    take: Path, tmp_path: Path, options: tuple[str, ...], told: str
) -> None:
    assert told in error_line(mien("animate", take, *options, cwd=tmp_path))
    assert not list(tmp_path.iterdir())


def test_errors_are_machine_readable_too(tmp_path: Path) -> None:
    done = mien("animate", "absent.mp4", "--json", cwd=tmp_path)
    assert done.returncode == 1
    assert json.loads(done.stdout)["error"] == "absent.mp4: no such file"


@pytest.mark.parametrize("options", [(), ("dance",), ("animate",), ("animate", "x", "--gain", "0")])
def test_wrong_usage_exits_2(tmp_path: Path, options: tuple[str, ...]) -> None:
    done = mien(*options, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr.startswith("usage: mien")


@needs_landmarks
@pytest.mark.parametrize(
    ("signum", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)], ids=["Ctrl-C", "kill"]
)
def test_an_interruption_leaves_nothing(tmp_path: Path, signum: int, code: int) -> None:
    grey = [np.full((64, 64, 3), 128, np.uint8)]
    write_video(tmp_path / "take.mp4", grey * 6000)
    running = start("animate", "take.mp4", "-o", "out", cwd=tmp_path)
    while not (tmp_path / "out").exists():
        assert running.poll() is None, running.communicate()
        time.sleep(0.01)
    time.sleep(0.5)  # into the middle of the take
    running.send_signal(signum)
    _, said = running.communicate(timeout=60)
    assert running.returncode == code, said
    assert len(said.splitlines()) <= 1
    assert [path.name for path in tmp_path.iterdir()] == ["take.mp4"]
