"""``mien report``: one file, which needs no other."""

from __future__ import annotations

import json
from pathlib import Path

from terminal import error_line, mien, needs_landmarks


@needs_landmarks
def test_a_report_of_a_take(take: Path, captured: Path, tmp_path: Path) -> None:
    done = mien("report", captured, "--pictures", take, "-c", "toy", "--json", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    told = json.loads(done.stdout)
    assert [path.name for path in tmp_path.iterdir()] == [told["file"]] == ["woman_toy.html"]
    page = (tmp_path / "woman_toy.html").read_text()
    assert page.count("the take at") >= 2
    assert "toy acts woman" in page
    assert told["suggestions"][0] in page


def test_a_report_is_html(tmp_path: Path) -> None:
    (tmp_path / "take.mien").touch()
    said = error_line(mien("report", "take.mien", "-c", "man", "-o", "r.pdf", cwd=tmp_path))
    assert "html" in said
