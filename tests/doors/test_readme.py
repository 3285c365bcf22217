"""Every code block of the README and the tutorial runs; those of the guides are read.

A block whose first line is "# needs a camera" (a phone, a browser, Blender ...) is only read: its
commands must be ones that mien has, with options that they take, and its Python must compile.
"""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from browser import ROOT, browse, needs_browser, served
from terminal import needs_landmarks

import mien
from guests import PICKS, write_vrm_guest
from mien.cli import main
from mien.face.databank import databank
from mien.face.face import Face
from mien.face.library import generic_face
from mien.formats.databank_file import write_databank
from mien.performance.marker_take import MarkerTake
from takes import WORN, c3d

RUN = (ROOT / "README.md", ROOT / "docs" / "tutorial.md")
READ = (*sorted((ROOT / "docs" / "guides").glob("*.md")), ROOT / "docs" / "figures.md")
OTHERS = ("make", ".", "blender", "dask")
"""Words that begin lines which are not mien's."""


@dataclass(frozen=True)
class Block:
    """A fenced block of a document."""

    place: str
    language: str
    text: str

    @property
    def runs(self) -> bool:
        """Whether it can be run without what its first line says it needs."""
        return not self.text.startswith("# needs ")

    def commands(self) -> Iterator[list[str]]:
        """Its lines as words, comments left out; a line that ends in a backslash goes on."""
        for line in self.text.replace("\\\n", " ").splitlines():
            if words := shlex.split(line, comments=True):
                yield words


def blocks(*paths: Path) -> list[Block]:
    found = []
    for path in paths:
        for match in re.finditer(r"^```(\w*)\n(.*?)^```$", path.read_text(), re.M | re.S):
            line = path.read_text()[: match.start()].count("\n") + 1
            found.append(Block(f"{path.name}:{line}", match[1], match[2]))
    return found


ALL = blocks(*RUN, *READ)


@pytest.mark.parametrize("block", ALL, ids=lambda block: block.place)
def test_a_block_says_what_mien_understands(block: Block) -> None:
    if block.language == "sh":
        for words in block.commands():
            _check(words)
    elif block.language == "python":
        compile(block.text, block.place, "exec")
    elif block.language == "toml":
        tomllib.loads(block.text)
    elif block.language == "js":
        _check_javascript(block.text)
    else:
        assert block.language == "text", f"{block.place}: says nothing of its language"


def _check(words: list[str]) -> None:
    if words[0].endswith("mien"):
        main._parser().parse_args(words[1:])
    elif words[0] == "make":
        targets = re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(), re.M)
        assert set(words[1:]) <= set(targets)
    elif words[0].endswith("python"):
        assert (ROOT / words[1]).is_file(), words
    else:
        assert words[0] in OTHERS, words


def _check_javascript(text: str) -> None:
    node = shutil.which("node")
    if node is None:
        pytest.skip("no Node to read JavaScript with")
    done = subprocess.run(
        [node, "--check", "--input-type=module", "-"], input=text, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory, take: Path) -> Path:
    """What the documents suppose is there: takes, characters, scans' worth of faces."""
    folder = tmp_path_factory.mktemp("documents")
    shutil.copy(take, folder / "take.mp4")
    woman = mien.load_character("woman")
    write_databank(folder / "bank.npz", databank(woman))
    _write_obj(woman.face, folder / "performer.obj")
    _write_markers(folder / "take.c3d")
    write_vrm_guest(folder)[0].rename(folder / "friend.vrm")
    _write_fox(folder)
    return folder


def _write_obj(face: Face, path: Path) -> None:
    lines = [f"v {x:.4f} {y:.4f} {z:.4f}\n" for x, y, z in face.vertices]
    lines += [f"f {a} {b} {c}\n" for a, b, c in face.triangles + 1]
    path.write_text("".join(lines))


def _write_markers(path: Path) -> None:
    generic = generic_face()
    rows = generic.face.points.index(list(WORN.values()))
    still = generic.face.points.at(generic.face.vertices)[rows]
    field = generic.face.points.at(generic.keys["jawOpen"])[rows]
    level = np.clip(np.arange(12) / 8.0 - 0.4, 0.0, 1.0)[:, None, None]
    c3d(MarkerTake(tuple(WORN), np.arange(12) / 30.0, still + level * field, source="act"), path)


def _write_fox(folder: Path) -> None:
    """A folder of OBJ files whose points somebody has picked, and its neutral by itself."""
    man = mien.load_character("man")
    (folder / "fox").mkdir()
    _write_obj(man.face, folder / "fox" / "neutral.obj")
    for name in ("smile", "jaw_open", "blink_left", "blink_right"):
        face = replace(man.face, vertices=man.face.vertices + man.keys[name])
        _write_obj(face, folder / "fox" / f"{name}.obj")
    shutil.copy(folder / "fox" / "neutral.obj", folder / "head.obj")
    picks = [f'"{fdp}" = {man.face.point(fdp).round(3).tolist()}' for fdp in PICKS]
    for name in ("fox.toml", "head.toml"):
        (folder / name).write_text("[points]\n" + "\n".join(picks) + "\n")


@needs_landmarks
@pytest.mark.parametrize("path", RUN, ids=lambda path: path.name)
def test_every_block_runs(
    path: Path, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    for block in blocks(path):
        if block.runs and block.language == "python":
            exec(compile(block.text, block.place, "exec"), {"__name__": block.place})
        elif block.runs and block.language == "sh":
            for words in block.commands():
                if words[0].endswith("mien"):
                    assert main.run(words[1:]) == 0, (block.place, words, capsys.readouterr().err)


THREE = ROOT / "studio" / "node_modules" / "three"
IMPORTS = {"three": "./three/build/three.module.js", "three/addons/": "./three/examples/jsm/"}


@needs_browser
@pytest.mark.skipif(not THREE.exists(), reason="no three.js: run make studio")
def test_the_web_page_of_the_tutorial_plays(captured: Path, tmp_path: Path) -> None:
    man = mien.load_character("man")
    (tmp_path / "out").mkdir()
    mien.save(mien.animate(mien.load_performance(captured), man), tmp_path / "out" / "man.glb", man)
    (tmp_path / "three").symlink_to(THREE)
    (script,) = (block.text for block in ALL if block.language == "js")
    (tmp_path / "index.html").write_text(
        f'<!doctype html><body><script type="importmap">{json.dumps({"imports": IMPORTS})}</script>'
        f'<script type="module">{script}</script>'
    )
    with served(tmp_path) as address:
        seen = browse("three_page.py", address, tmp_path)
    assert seen["errors"] == []
    assert seen["pictures"] > 3
