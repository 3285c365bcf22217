"""The studio as somebody opens it: in Chromium, with a video as the camera."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
from pathlib import Path

import cv2
import pytest
from terminal import MIEN, needs_landmarks

from mien.formats.pictures.sources import open_source

HERE = Path(__file__).parent
BROWSER_PYTHON = Path(
    os.environ.get("MIEN_BROWSER_PYTHON") or HERE.parents[1] / ".tools" / "browser/bin/python"
)
CHROMIUM = os.environ.get("MIEN_CHROMIUM") or shutil.which("chromium")
PAGE = HERE.parents[1] / "src/mien/live/studio/page/index.html"

pytestmark = [
    needs_landmarks,
    pytest.mark.skipif(
        CHROMIUM is None or not BROWSER_PYTHON.exists(),
        reason="no Chromium with Playwright: run .ci/tools.sh, or set MIEN_BROWSER_PYTHON",
    ),
    pytest.mark.skipif(not PAGE.exists(), reason="the page is not built: run make studio"),
]


@pytest.fixture
def camera(tmp_path: Path) -> Path:
    """The sample performance as Chromium's fake camera reads it."""
    sample = HERE.parents[1] / "src/mien/data/sample.mp4"
    path = tmp_path / "camera.mjpeg"
    with path.open("wb") as file:
        for frame in open_source(str(sample)):
            picture = cv2.resize(frame.image, (480, 480))[:, :, ::-1]
            file.write(cv2.imencode(".jpg", picture)[1].tobytes())
    return path


def test_a_performer_moves_the_characters_and_keeps_a_take(camera: Path, tmp_path: Path) -> None:
    command = [MIEN, "studio", "--no-browser", "--port", "0", "--folder", tmp_path / "folder"]
    server = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, text=True)
    assert server.stdout is not None
    try:
        address = server.stdout.readline().split()[4]
        run = subprocess.run(
            [BROWSER_PYTHON, HERE / "page.py", address, camera, CHROMIUM, tmp_path],
            capture_output=True,
            text=True,
            timeout=240,
            check=False,
        )
        assert run.returncode == 0, run.stderr
        seen = json.loads(run.stdout)
    finally:
        server.send_signal(signal.SIGTERM)
        server.wait(20)
    assert seen["errors"] == []
    assert seen["foreign"] == []
    assert seen["weights_moved"] > 0.3
    assert seen["canvas_changed"]
    assert Path(seen["export"]).read_bytes()[:4] == b"glTF"
