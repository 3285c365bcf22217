"""The documentation as a site: it builds without a broken link, and reading it asks nobody else."""

from __future__ import annotations

import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import threading
from collections.abc import Iterator
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
BROWSER_PYTHON = Path(
    os.environ.get("MIEN_BROWSER_PYTHON") or ROOT / ".tools" / "browser/bin/python"
)
CHROMIUM = os.environ.get("MIEN_CHROMIUM") or shutil.which("chromium")
PAGES = ("index.html", "tutorial.html", "papers/equations.html", "papers/online_mapping.html")

pytestmark = pytest.mark.skipif(
    importlib.util.find_spec("mkdocs") is None, reason="no MkDocs: run make docs"
)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", folder],
        cwd=ROOT,
        env=os.environ | {"NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return folder


def test_nothing_that_is_shown_comes_from_elsewhere(site: Path) -> None:
    fetched = re.compile(r'<(?:script|img|source|link rel="stylesheet")[^>]*?(?:src|href)="(.*?)"')
    pages = sorted(site.rglob("*.html"))
    assert len(pages) > 30
    for page in pages:
        for address in fetched.findall(page.read_text(encoding="utf-8")):
            assert not re.match(r"(https?:)?//", address), (page.name, address)
            if page.name != "404.html":
                assert (page.parent / address.partition("?")[0]).exists(), (page.name, address)
    for sheet in site.rglob("*.css"):
        assert not re.search(r"url\(['\"]?(https?:)?//", sheet.read_text(encoding="utf-8"))


def test_every_equation_is_drawn(site: Path) -> None:
    text = (site / "papers" / "equations.html").read_text(encoding="utf-8")
    assert text.count("<math") >= 15
    assert "arithmatex" not in text


@pytest.fixture
def address(site: Path) -> Iterator[str]:
    class Quiet(SimpleHTTPRequestHandler):
        def log_message(self, *_: object) -> None:
            """Tests say what matters."""

    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=str(site)))
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"http://127.0.0.1:{server.server_port}"
    server.shutdown()


@pytest.mark.skipif(
    CHROMIUM is None or not BROWSER_PYTHON.exists(),
    reason="no Chromium with Playwright: run .ci/tools.sh, or set MIEN_BROWSER_PYTHON",
)
def test_a_reader_asks_this_machine_alone(address: str, tmp_path: Path) -> None:
    done = subprocess.run(
        [BROWSER_PYTHON, HERE / "site_pages.py", address, CHROMIUM, tmp_path, *PAGES],
        capture_output=True,
        text=True,
        timeout=240,
    )
    assert done.returncode == 0, done.stderr
    seen = json.loads(done.stdout)
    assert len(seen["requests"]) > 20
    foreign = [url for url in seen["requests"] if not url.startswith((address, "data:", "blob:"))]
    assert foreign == []
    assert seen["errors"] == []
    assert not any(seen["broken"].values()), seen["broken"]
    assert seen["found"] > 3
