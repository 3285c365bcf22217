"""Chromium, where .ci/tools.sh has put what drives it, and a folder served to it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import pytest

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
BROWSER_PYTHON = Path(
    os.environ.get("MIEN_BROWSER_PYTHON") or ROOT / ".tools" / "browser/bin/python"
)
CHROMIUM = os.environ.get("MIEN_CHROMIUM") or shutil.which("chromium")

needs_browser = pytest.mark.skipif(
    CHROMIUM is None or not BROWSER_PYTHON.exists(),
    reason="no Chromium with Playwright: run .ci/tools.sh, or set MIEN_BROWSER_PYTHON",
)


class _Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Tests say what matters."""


@contextmanager
def served(folder: Path) -> Iterator[str]:
    """The address at which ``folder`` is served."""
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(_Quiet, directory=str(folder)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()


def browse(script: str, *arguments: object) -> dict[str, Any]:
    """What a ``script`` of this folder, run with Playwright, prints as JSON; it is given Chromium
    and then ``arguments``."""
    done = subprocess.run(
        [BROWSER_PYTHON, HERE / script, str(CHROMIUM), *map(str, arguments)],
        capture_output=True,
        text=True,
        timeout=240,
    )
    assert done.returncode == 0, done.stderr
    found: dict[str, Any] = json.loads(done.stdout)
    return found
