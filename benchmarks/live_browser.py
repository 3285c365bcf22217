"""Whether weights come thirty times a second while Chromium draws the characters beside the studio.

    python benchmarks/live_browser.py [--seconds 20] [--json]

A page without a browser sends its pictures and counts its weights as in live_latency.py, first with
one character on stage and then with four, while headless Chromium has a page of the same studio
open, the sample as its camera. Told of that are milliseconds from a picture of the camera to the
canvas and how often it draws, in software, which is not judged. Needs Chromium, and a Python that
has Playwright (MIEN_BROWSER_PYTHON, MIEN_CHROMIUM, or what .ci/tools.sh fetches).
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import mien
from live_latency import acted, jpegs
from report import show
from socket_page import running_studio

HERE = Path(__file__).parent


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=20.0)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    python = os.environ.get("MIEN_BROWSER_PYTHON", HERE.parent / ".tools/browser/bin/python")
    chromium = os.environ.get("MIEN_CHROMIUM") or shutil.which("chromium")
    if chromium is None or not Path(python).exists():
        raise SystemExit("no Chromium with Playwright: run .ci/tools.sh")
    pictures, figures = jpegs(None), {}
    with tempfile.TemporaryDirectory() as name, running_studio(Path(name)) as studio:
        camera = Path(name, "camera.mjpeg")
        camera.write_bytes(b"".join(pictures))
        address = f"http://127.0.0.1:{studio.port}/"
        command = [python, HERE / "browser_page.py", address, camera, chromium]
        with subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        ) as beside:
            assert beside.stdout is not None
            if beside.stdout.readline().strip() != "following":
                raise SystemExit("Chromium did not show the page")
            for name, cast in (("one", mien.CHARACTERS[:1]), ("four", mien.CHARACTERS)):
                run = acted(studio, pictures, "landmarks", list(cast), options.seconds)
                figures[f"fps_{name}"] = run.rate
                figures[f"dropped_{name}"] = float(run.sent - len(run.server))
                figures[f"p95_ms_{name}"] = float(np.quantile(run.server, 0.95))
            figures |= json.loads(beside.communicate("enough\n", 60)[0])
    show("live_browser", "Live, with Chromium beside", figures, options.json)


if __name__ == "__main__":
    main()
