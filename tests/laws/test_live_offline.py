"""Live equals offline: the same pictures, performer and causal filter give the same weights."""

from __future__ import annotations

from importlib.resources import files
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("mediapipe", reason="the extra 'landmarks' is not installed")

from clips import write_video
from mien.capture.stepping import meet
from mien.face.library import load_character
from mien.formats.performer_file import read_performer
from mien.formats.pictures.sources import open_source
from mien.live.stage import Stage
from mien.recipe import animate, calibrate, capture

CAST = ("man", "toy")


@pytest.fixture(scope="module")
def clip(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The start of the clip that is shipped, and beside it what is known of its performer."""
    folder = tmp_path_factory.mktemp("clip")
    source = open_source(Path(str(files("mien") / "data" / "sample.mp4")))
    path = write_video(folder / "clip.mp4", [frame.image for frame in islice(source, 45)])
    calibrate([path], folder / "her.performer")
    return path


@pytest.mark.parametrize("method", ["landmarks", "snakes"])
def test_the_same_weights_live_and_offline(method: str, clip: Path) -> None:
    known = clip.with_name("her.performer")
    take = capture(clip, method=method, performer=known)
    cast = [load_character(name) for name in CAST]
    stage = Stage(cast, meet(method, read_performer(known)))
    moments = [stage.see(frame) for frame in open_source(clip)]
    assert len(moments) == len(take)
    for character in cast:
        whole = animate(take, character, causal=True)
        assert np.abs(whole.weights - animate(take, character).weights).max() > 1e-3
        for number, moment in enumerate(moments):
            assert moment.curves is not None
            one = moment.curves[character.name]
            assert one.names == whole.names
            for name in ("weights", "rotation", "translation", "gaze"):
                theirs = getattr(whole, name)[number]
                np.testing.assert_allclose(getattr(one, name)[0], theirs, atol=1e-6)
