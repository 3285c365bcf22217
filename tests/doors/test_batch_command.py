"""``mien batch``: what is done is done once, whatever happens in between."""

from __future__ import annotations

import importlib.util
import json
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from terminal import error_line, mien, needs_landmarks, start

from actors import FACE_ON, built_in, shown
from clips import write_video
from mien.cli.main import run
from mien.face.animate import Poser
from mien.formats.takes.mien_file import write_performance
from mien.view.camera import Camera
from mien.view.renderer import Renderer

needs_dask = pytest.mark.skipif(
    importlib.util.find_spec("distributed") is None, reason="needs the extra 'batch'"
)
FRAMES = 10
CAST = ("man", "woman", "toy")
CHOSEN = [part for name in CAST for part in ("-c", name)]
ACTED = ("smile", "jaw_open", "blink_left")
STOPS = ((signal.SIGKILL, 2), (signal.SIGINT, 5))
"""Signals, and how many results there are when each is sent."""


@pytest.fixture(scope="module")
def takes(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three short takes, one of them twice, and two files that are none."""
    folder = tmp_path_factory.mktemp("takes")
    woman = built_in("woman")
    poser, renderer = Poser(woman.face, woman.keys), Renderer(woman.face)
    for key in ACTED:
        acted = np.zeros((FRAMES, len(woman.keys.names)))
        acted[:, woman.keys.names.index(key)] = np.sin(np.arange(FRAMES) / 3)
        pictures = [renderer.render(poser.pose(w), Camera(size=(256, 256))) for w in acted]
        write_video(folder / f"{key}.mp4", pictures)
    (folder / "again").mkdir()
    (folder / "again/copy.mp4").write_bytes((folder / "smile.mp4").read_bytes())
    (folder / "letter.mp4").write_text("dear diary\n")
    (folder / "empty.mp4").touch()
    return folder


@needs_dask
@needs_landmarks
def test_a_batch_that_is_killed_goes_on_where_it_stopped(takes: Path, tmp_path: Path) -> None:
    said = error_line(mien("batch", takes, "-o", "plain", *CHOSEN, "--workers", 1, cwd=tmp_path))
    assert "2 of 6 takes and 0 single characters failed" in said
    assert "letter.mp4: not a video" in said
    kept: dict[str, tuple[int, int]] = {}
    for stop, count in STOPS:
        process = start("batch", takes, "-o", "stopped", *CHOSEN, "--workers", 1, cwd=tmp_path)
        while len(done(tmp_path / "stopped")) < count:
            assert process.poll() is None, process.communicate()
            time.sleep(0.01)
        process.send_signal(stop)
        process.communicate(timeout=60)
        assert process.returncode == (130 if stop == signal.SIGINT else -stop)
        time.sleep(1.0)  # for workers to notice that nobody waits for them
        assert done(tmp_path / "stopped").items() >= kept.items()
        kept = done(tmp_path / "stopped")
        assert len(kept) < len(ACTED) * len(CAST), "it was done before it was stopped"
    assert not list(hidden(tmp_path / "stopped")), "Ctrl-C leaves nothing behind"
    error_line(mien("batch", takes, "-o", "stopped", *CHOSEN, "--workers", 2, cwd=tmp_path))

    account = json.loads((tmp_path / "stopped/batch.json").read_text())
    assert account["run"]["count"]["acts_found"] == len(kept)
    assert account["run"]["count"]["acted"] == len(ACTED) * len(CAST) - len(kept)
    assert done(tmp_path / "stopped").items() >= kept.items()
    stopped, plain = contents(tmp_path / "stopped"), contents(tmp_path / "plain")
    assert stopped.keys() == plain.keys()
    # The report's pictures may round a pixel otherwise; results may not.
    assert {n: b for n, b in stopped.items() if not n.endswith(".jpg")} == {
        n: b for n, b in plain.items() if not n.endswith(".jpg")
    }
    assert not list(hidden(tmp_path / "stopped"))
    failed = {take["name"]: take["error"] for take in account["takes"] if "error" in take}
    assert failed.keys() == {"letter", "empty"}
    named = {path.relative_to(tmp_path).as_posix() for path in tmp_path.glob("stopped/takes/*/*")}
    assert named == {
        f"stopped/takes/{take}/{name}.glb" for take in (*ACTED, "copy") for name in CAST
    }
    page = (tmp_path / "stopped/index.html").read_text()
    assert all(name in page for name in ("smile", "letter.mp4", "not a video", *CAST))


@needs_dask
def test_a_killed_worker_stops_no_other_take(tmp_path: Path) -> None:
    man = built_in("man")
    for number, level in enumerate((0.5, 1.0)):
        acted = np.zeros((FRAMES, len(man.examples)))
        acted[5:, number] = level
        write_performance(shown(man, acted, unseen=FACE_ON), tmp_path / f"take{number}.mien")
    arguments = ["batch", "take0.mien", "take1.mien", "-c", "toy", "-f", "csv", "-o", "out"]
    process = start(*arguments, "--workers", 1, "--json", cwd=tmp_path)
    while not (workers := children(process.pid)):
        assert process.poll() is None, process.communicate()
        time.sleep(0.01)
    os.kill(workers[0], signal.SIGKILL)  # before it has begun
    while not done(tmp_path / "out") and process.poll() is None:
        time.sleep(0.01)
    for worker in children(process.pid):
        os.kill(worker, signal.SIGKILL)  # between two takes, or after both
    told, _ = process.communicate(timeout=120)
    assert process.returncode == 0
    assert json.loads(told)["run"]["count"]["acted"] == 2
    assert len(list(tmp_path.glob("out/takes/*/toy.csv"))) == 2


Line = Callable[..., str]


@pytest.fixture
def said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Line:
    """The one line that ``mien batch`` says before it gives up."""
    (tmp_path / "take.mien").touch()
    (tmp_path / "empty").mkdir()
    monkeypatch.chdir(tmp_path)

    def run_it(*arguments: str) -> str:
        assert run(["batch", *arguments, "-o", "out"]) == 1
        told = capsys.readouterr()
        assert told.out == ""
        (line,) = told.err.splitlines()
        return line

    return run_it


@needs_dask
@pytest.mark.parametrize(
    ("arguments", "word"),
    [
        (("absent.mp4",), "no such file"),
        (("empty",), "holds no takes"),
        (("take.mien", "-c", "nobody"), "nobody"),
        (("take.mien", "-c", "man", "-c", "man"), "twice"),
        (("take.mien", "-f", "docx"), "docx"),
    ],
)
def test_what_cannot_begin_is_told_in_a_line(
    said: Line, arguments: tuple[str, ...], word: str
) -> None:
    assert word in said(*arguments)
    assert not Path("out").exists()


@needs_dask
def test_a_scheduler_that_does_not_answer(said: Line, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mien.batch.cluster.PATIENCE", 1)
    line = said("take.mien", "-c", "man", "--scheduler", "tcp://127.0.0.1:9")
    assert "--scheduler tcp://127.0.0.1:9: nobody answers" in line


def test_without_the_extra_it_says_so(said: Line, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "dask", None)
    assert "mien[batch]" in said("take.mien", "-c", "man")


def done(out: Path) -> dict[str, tuple[int, int]]:
    """Inode and time of every finished result."""
    folder = out / "results"
    entries = [] if not folder.exists() else list(folder.iterdir())
    states = {entry.name: entry.stat() for entry in entries if not entry.name.startswith(".")}
    return {name: (state.st_ino, state.st_mtime_ns) for name, state in states.items()}


def contents(out: Path) -> dict[str, bytes]:
    """All that a batch made but for its account and report, which tell times."""
    return {
        path.relative_to(out).as_posix(): path.read_bytes()
        for kind in ("captures", "results", "takes")
        for path in (out / kind).rglob("*")
        if path.is_file()
    }


def hidden(out: Path) -> Iterator[Path]:
    return (path for path in out.rglob("*") if path.name.startswith("."))


def children(process: int) -> list[int]:
    """The worker processes of a batch."""
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            number, parent = status.parent.name, status.read_text().rpartition(")")[2].split()[1]
            command = (status.parent / "cmdline").read_text()
        except OSError:
            continue
        if int(parent) == process and "spawn_main" in command:
            found.append(int(number))
    return found
