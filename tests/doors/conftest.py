"""A take for the commands: the woman, rendered, smiles and winks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from terminal import FRAMES, WINK, mien

from clips import write_video
from mien.face.animate import Poser
from mien.face.library import load_character
from mien.view.camera import Camera
from mien.view.renderer import Renderer


@pytest.fixture(scope="session")
def take(tmp_path_factory: pytest.TempPathFactory) -> Path:
    woman = load_character("woman")
    poser, renderer = Poser(woman.face, woman.keys), Renderer(woman.face)
    pictures = []
    for i in range(FRAMES):
        weights = np.zeros(len(woman.keys.names))
        weights[woman.keys.names.index("smile")] = max(0.0, np.sin(i / 2))
        weights[woman.keys.names.index("blink_left")] = float(WINK.start <= i < WINK.stop)
        pictures.append(renderer.render(poser.pose(weights), Camera(size=(256, 256))))
    return write_video(tmp_path_factory.mktemp("take") / "woman.mp4", pictures)


@pytest.fixture(scope="session")
def captured(take: Path) -> Path:
    """The take as a .mien file, so that what only maps need not look again."""
    path = take.with_suffix(".mien")
    done = mien("capture", take, "-o", path, cwd=take.parent)
    assert done.returncode == 0, done.stderr
    return path
