"""A captured take, from its pictures to the file another program opens."""

from __future__ import annotations

from importlib import resources
from pathlib import Path

import numpy as np
import pytest

import mien
from foreign import blender, issues, needs_blender, needs_validator
from mien.face.character import Character
from mien.performance.curves import Curves

pytest.importorskip("mediapipe", reason="needs the extra 'landmarks'")


@pytest.fixture(scope="module")
def man() -> Character:
    return mien.load_character("man")


@pytest.fixture(scope="module")
def curves(man: Character) -> Curves:
    with resources.as_file(resources.files("mien").joinpath("data", "sample.mp4")) as sample:
        return mien.animate(mien.capture(sample, end=2.0), man)


@pytest.fixture(scope="module")
def written(man: Character, curves: Curves, tmp_path_factory: pytest.TempPathFactory) -> Path:
    return mien.save(curves, tmp_path_factory.mktemp("take") / "man.glb", man)


def test_the_take_has_a_frame_for_every_picture(curves: Curves) -> None:
    np.testing.assert_allclose(np.diff(curves.time), 1.0 / 30.0, atol=1e-3)
    assert len(curves) in (60, 61)
    assert curves.weights.max() > 0.3


@needs_validator
def test_the_validator_is_silent(written: Path) -> None:
    assert issues(written) == []


@needs_blender
def test_blender_has_our_names_values_and_times(written: Path, curves: Curves) -> None:
    found = blender(written)
    assert found["face"]["shape_keys"] == ["Basis", *curves.names]
    for column, name in enumerate(curves.names):
        key = found["face"]["weights"][f'key_blocks["{name}"].value#0']
        np.testing.assert_allclose(key["value"], curves.weights[:, column], atol=1e-4)
        np.testing.assert_allclose(key["time"], curves.time, atol=1e-3)
