"""The documentation as a site: it builds without a broken link, and reading it asks nobody else."""

from __future__ import annotations

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from browser import ROOT, browse, needs_browser, served

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


@needs_browser
def test_a_reader_asks_this_machine_alone(site: Path, tmp_path: Path) -> None:
    with served(site) as address:
        seen = browse("site_pages.py", address, tmp_path, *PAGES)
    assert len(seen["requests"]) > 20
    foreign = [url for url in seen["requests"] if not url.startswith((address, "data:", "blob:"))]
    assert foreign == []
    assert seen["errors"] == []
    assert not any(seen["broken"].values()), seen["broken"]
    assert seen["found"] > 3
