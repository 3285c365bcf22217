"""The studio as somebody opens it: in Chromium, with a video as the camera."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import wave
from collections.abc import Iterator
from pathlib import Path

import av
import cv2
import numpy as np
import pytest
from terminal import MIEN, needs_landmarks

from foreign import VALIDATOR, issues
from guests import edited, guest, write_guest
from mien.formats.performer_file import read_performer
from mien.formats.pictures.sources import open_source
from mien.recipe import load_performance
from mien.rig.picks import read_picks

HERE = Path(__file__).parent
BROWSER_PYTHON = Path(
    os.environ.get("MIEN_BROWSER_PYTHON") or HERE.parents[1] / ".tools" / "browser/bin/python"
)
CHROMIUM = os.environ.get("MIEN_CHROMIUM") or shutil.which("chromium")
PAGE = HERE.parents[1] / "src/mien/live/studio/page/index.html"

ORDER = ("9.3", "3.11", "3.7", "3.1", "3.3", "4.3", "8.3", "8.1", "2.2", "2.3", "8.2", "2.1")
"""In which the page asks for points."""

pytestmark = [
    needs_landmarks,
    pytest.mark.skipif(
        CHROMIUM is None or not BROWSER_PYTHON.exists(),
        reason="no Chromium with Playwright: run .ci/tools.sh, or set MIEN_BROWSER_PYTHON",
    ),
    pytest.mark.skipif(not PAGE.exists(), reason="the page is not built: run make studio"),
]


SAMPLE = HERE.parents[1] / "src/mien/data/sample.mp4"
SQUASHED = np.array([1.0, 0.35, 1.0])
"""A face so flat that nobody finds it by looking."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """What the page is given: a camera, a film with sound, and a character nobody recognises."""
    with (tmp_path / "camera.mjpeg").open("wb") as file:
        for frame in open_source(str(SAMPLE)):
            picture = cv2.resize(frame.image, (480, 480))[:, :, ::-1]
            file.write(cv2.imencode(".jpg", picture)[1].tobytes())
    with_sound(SAMPLE, tmp_path / "film.mp4")
    path, _ = write_guest(tmp_path / "guest")
    edited(path, lambda told: told["nodes"][1].update(scale=SQUASHED.tolist()))
    path.rename(tmp_path / "squashed.glb")
    face = guest().face
    places = [(face.point(fdp) * SQUASHED / 1e3).tolist() for fdp in ORDER]
    (tmp_path / "squashed.json").write_text(json.dumps(places))
    return tmp_path


def with_sound(silent: Path, path: Path) -> None:
    """The pictures of a film, and a tone."""
    with av.open(str(silent)) as source, av.open(str(path), "w") as target:
        pictures = source.streams.video[0]
        copied = target.add_stream_from_template(pictures)
        sound = target.add_stream("aac", rate=44100)
        for packet in source.demux(pictures):
            if packet.dts is not None:
                packet.stream = copied
                target.mux(packet)
        tone = 0.2 * np.sin(np.arange(44100 * 6) * 0.06).astype(np.float32)
        for first in range(0, len(tone) - 1024, 1024):
            frame = av.AudioFrame.from_ndarray(tone[None, first : first + 1024], "fltp", "mono")
            frame.sample_rate, frame.pts = 44100, first
            target.mux(sound.encode(frame))
        target.mux(sound.encode(None))


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    """A studio."""
    command = [MIEN, "studio", "--no-browser", "--port", "0", "--folder", tmp_path / "shelf"]
    server = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    assert server.stdout is not None
    yield server.stdout.readline().split()[4]
    server.send_signal(signal.SIGTERM)
    server.wait(20)


def test_the_page_as_a_person_uses_it(folder: Path, address: str) -> None:
    run = subprocess.run(
        [BROWSER_PYTHON, HERE / "page.py", address, folder / "camera.mjpeg", CHROMIUM, folder],
        capture_output=True,
        text=True,
        timeout=400,
        check=False,
    )
    print(run.stderr)  # how long each step took
    assert run.returncode == 0
    seen = json.loads(run.stdout)
    assert seen["errors"] == []
    assert seen["foreign"] == []
    assert seen["first"] == "sample"
    assert seen["weights_moved"] > 0.3
    assert seen["canvas_changed"]
    assert seen["late_ms"]
    assert all(late > 0.0 for late in seen["late_ms"])
    assert seen["rest"] in ("good", "shaky")
    assert seen["learnt"] == seen["met"] == 1
    assert len(read_performer(Path(seen["performer"])).held) == 1
    assert seen["still"]
    assert seen["wound"] == 0.8
    assert Path(seen["export"]).read_bytes()[:4] == b"glTF"
    if VALIDATOR.exists():
        assert issues(Path(seen["export"])) == []
    assert Path(seen["table"]).read_text().startswith("time")
    assert len(load_performance(seen["told"])) > 2
    assert seen["take_moved"] > 0.02
    assert seen["guest_moved"] > 0.1
    picks = read_picks(folder / "shelf" / "squashed.toml")
    wanted = json.loads((folder / "squashed.json").read_text())
    missed = [np.linalg.norm(picks[fdp] - place) for fdp, place in zip(ORDER, wanted, strict=True)]
    assert np.median(missed) < 2e-3
    assert "No camera" in seen["told_of_camera"]
    assert (folder / "shelf" / "told.mien").exists()
    (sound,) = (folder / "shelf").glob("*.wav")
    with wave.open(str(sound)) as file:
        assert file.getnframes() > file.getframerate() / 2
