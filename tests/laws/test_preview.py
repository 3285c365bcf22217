"""The film of a take and the sheet of a character."""

from __future__ import annotations

import numpy as np
import pytest

from faces import toy_curves
from mien.face.character import Character
from mien.performance.frame import Frame
from mien.view.contact_sheet import contact_sheet
from mien.view.preview import preview


def performer(frames: int) -> list[Frame]:
    return [Frame(np.full((90, 160, 3), 10 * i, dtype=np.uint8), 9.9 * i) for i in range(frames)]


@pytest.mark.parametrize(
    ("actors", "size"), [(1, (540, 960 + 540)), (2, (720, 1280 + 360)), (3, (720, 1280 + 720))]
)
def test_performer_and_characters_share_a_frame(
    toy_face: Character, actors: int, size: tuple[int, int]
) -> None:
    curves = toy_curves(toy_face, 3)
    film = list(preview([(toy_face, curves)] * actors, performer(3)))
    assert [frame.time for frame in film] == list(curves.time)
    for i, frame in enumerate(film):
        assert frame.image.shape == (*size, 3)
        assert (frame.image[:, : size[0] * 16 // 9] == 10 * i).all()


def test_a_very_wide_picture_does_not_make_a_very_wide_film(toy_face: Character) -> None:
    wide = [Frame(np.full((20, 8000, 3), 200, dtype=np.uint8), 0.0)]
    (frame,) = preview([(toy_face, toy_curves(toy_face, 1))], wide)
    assert frame.image.shape == (540, 1296 + 540, 3)
    assert (frame.image[269, :1296] == 200).all()
    assert (frame.image[0, :1296] < 50).all()


def test_characters_act_without_a_performer(toy_face: Character) -> None:
    curves = toy_curves(toy_face, 6)
    film = list(preview([(toy_face, curves)], threads=1))
    assert len(film) == 6
    assert film[0].image.shape == (540, 540, 3)
    assert not np.array_equal(film[0].image, film[1].image)


def test_threads_do_not_change_the_film(toy_face: Character) -> None:
    acts = [(toy_face, toy_curves(toy_face, 4))] * 2
    for one, two in zip(preview(acts, threads=1), preview(acts, threads=3), strict=True):
        # Sums that are dealt out otherwise may round a pixel otherwise.
        apart = np.abs(one.image.astype(int) - two.image)
        assert apart.max() <= 2
        assert np.count_nonzero(apart) < 1e-3 * apart.size


def test_a_sheet_shows_four_sides_and_every_key_model(toy_face: Character) -> None:
    sheet = contact_sheet(toy_face)
    # Four views in one row, four key models in a row of five.
    assert sheet.shape == (400 + 320, 1600, 3)
    cells = [sheet[400 + 40 : 720, 320 * i : 320 * i + 300] for i in range(5)]
    for i in range(4):
        assert cells[i].std() > 10
        assert not np.array_equal(cells[i], cells[i + 1])
