"""The skin's texture coordinates: one piece, nothing folded, the same on both sides."""

from __future__ import annotations

import numpy as np
import pytest

from mien.face.library import CHARACTERS, GENERIC, load_character
from mien.sculpt.anatomy.cage import cage

NAMES = (GENERIC, *CHARACTERS)


@pytest.mark.parametrize("name", NAMES)
def test_nothing_folds_over(name: str) -> None:
    face = load_character(name).face
    assert face.uv is not None
    first, second, third = np.moveaxis(face.uv[face.part("skin").triangles], 1, 0)
    (ax, ay), (bx, by) = (second - first).T, (third - first).T
    # v runs down, so that counter-clockwise triangles have negative areas.
    assert (ax * by - ay * bx < 0.0).all()


@pytest.mark.parametrize("name", NAMES)
def test_left_mirrors_right(name: str) -> None:
    uv = load_character(name).face.uv
    assert uv is not None
    skin = uv[: len(cage().fine_mirror)]
    partner = skin[cage().fine_mirror]
    assert np.abs(skin[:, 0] + partner[:, 0] - 1.0).max() < 1e-4
    assert np.abs(skin[:, 1] - partner[:, 1]).max() < 1e-4


@pytest.mark.parametrize("name", NAMES)
def test_everything_lies_in_its_picture_and_no_two_parts_share_a_place(name: str) -> None:
    face = load_character(name).face
    assert face.uv is not None
    assert face.uv.min() >= 0.0
    assert face.uv.max() <= 1.0
    skin = face.part("skin")
    boxes: dict[str, list[tuple[np.ndarray, np.ndarray]]] = {}
    for part in face.parts:
        uv = face.uv[part.first : part.last]
        if part is skin:
            continue
        low, high = uv.min(axis=0), uv.max(axis=0)
        for other_low, other_high in boxes.setdefault(part.material, []):
            assert (low > other_high).any() or (high < other_low).any()
        boxes[part.material].append((low, high))
        if part.material == skin.material:
            assert np.linalg.norm(uv - 0.5, axis=1).min() > 0.49


def test_one_layout_fits_all_of_the_cast() -> None:
    count = len(cage().fine_mirror)
    layouts = [load_character(name).face.uv for name in NAMES]
    for layout in layouts[1:]:
        assert layout is not None
        assert np.array_equal(layout[:count], layouts[0][:count])
