"""An open mouth is what lips enclose, and skin that glows like lips is told from them."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from mien.capture.snakes.colour.glow import dimmed, excess
from mien.capture.snakes.colour.pigments import Pigments, pigments
from mien.capture.snakes.colour.skin import USUAL_SKIN
from mien.capture.snakes.colour.transform import Field, contrast
from mien.capture.snakes.gape import _BRIGHTEST, _DEEP, _FILL, _LIT, _worths, find_gape
from mien.capture.snakes.head.patch import HEIGHT, WIDTH
from mien.capture.snakes.mouth import LipColour

Array = NDArray[np.float64]

LIPS = LipColour(160.0, 0.4)
DARK, TOOTH, SHADED = (30.0, 20.0, 18.0), (190.0, 180.0, 170.0), (130.0, 98.0, 85.0)
ROWS, COLUMNS = 54, 66


def scene(inside: tuple[float, float, float], around: float) -> tuple[Field, Pigments]:
    """A mouth 30 by 10 pixels large, with so much I on a ring round it."""
    colours = np.tile(USUAL_SKIN, (ROWS, COLUMNS, 1))
    colours[20:30, 18:48] = inside
    field = np.full((ROWS, COLUMNS), 0.05, np.float32)
    field[15:36, 14:52] = around
    field[20:30, 18:48] = 0.05
    patch = np.zeros((HEIGHT // 2, WIDTH // 2, 3), np.uint8)
    patch[:ROWS, :COLUMNS] = colours
    return field, pigments(patch, np.ones(3), (0, 0, COLUMNS, ROWS), 2)


@pytest.mark.parametrize("inside", [DARK, TOOTH, SHADED])
def test_a_mouth_is_lit_up_where_lips_lie_round_it(inside: tuple[float, float, float]) -> None:
    found = find_gape(*scene(inside, 0.6), LIPS)
    assert (found.field[20:30, 18:48] > 0.8).all()
    assert (found.field[:15] < 0.1).all()
    assert found.lens is not None
    assert found.lens[1, 0] - found.lens[0, 0] == pytest.approx(2 * 30 + 20)


@pytest.mark.parametrize("inside", [DARK, TOOTH])
def test_a_moustache_or_a_glint_on_skin_is_no_mouth(inside: tuple[float, float, float]) -> None:
    found = find_gape(*scene(inside, 0.1), LIPS)
    assert found.lens is None
    assert found.field.max() < 0.2


@pytest.mark.parametrize("inside", [TOOTH, SHADED])
def test_teeth_above_a_lip_are_a_mouth(inside: tuple[float, float, float]) -> None:
    field, seen = scene(inside, 0.6)
    field[:20] = 0.05
    field[20:30, 18:48] = 0.01
    assert (find_gape(field, seen, LIPS).field[20:30, 18:48] > 0.8).all()


@pytest.mark.parametrize("below", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_what_lies_round_a_part(seed: int, below: bool) -> None:
    random = np.random.default_rng(seed)
    mask = (random.random((14, 17)) < 0.35).astype(np.uint8)
    field = random.random(mask.shape, dtype=np.float32)
    count, label, boxes, _ = cv2.connectedComponentsWithStats(mask, connectivity=4)
    side = 2 * _DEEP + 1
    edge = cv2.morphologyEx(mask, cv2.MORPH_GRADIENT, np.ones((side, side), np.uint8))
    worth, best = _worths(label, edge, boxes, field, 2.0, below)
    reach = np.zeros((side, side), np.uint8)
    reach[:, _DEEP if below else slice(None)] = 1
    if below:
        reach[_DEEP + 1 :] = 0
    areas = {0: 0}
    for n in range(1, count):
        own = (label == n).astype(np.uint8)
        rim = cv2.dilate(own, reach, borderValue=0).astype(bool) & (label != n)
        ys, xs = np.nonzero(own)
        enclosed = ys.min() > 0 and xs.min() > 0 and ys.max() < 13 and xs.max() < 16
        mean = float(field[rim].mean()) if rim.any() else 0.0
        counts = enclosed and len(ys) >= 2 and mean > _LIT
        assert worth[n] == pytest.approx(min(_FILL * mean, _BRIGHTEST) if counts else 0.0)
        if counts:
            areas[n] = len(ys)
    assert areas.get(best) == max(areas.values())


def test_what_glows_is_taken_off_until_a_fifth_is_lips() -> None:
    field = contrast(np.linspace(0.3, 1.1, 1000)).astype(np.float32)
    glow = excess(field, None)
    assert glow == pytest.approx(0.3 + 0.8 * 0.8 - 0.5, abs=0.01)
    assert (dimmed(field, glow) > 0.5).mean() == pytest.approx(0.2, abs=0.01)
    assert np.allclose(dimmed(field, glow), contrast(np.linspace(0.3, 1.1, 1000) - glow), atol=1e-4)
    plain = contrast(np.linspace(0.0, 0.55, 1000)).astype(np.float32)
    assert dimmed(plain, excess(plain, None)) is plain


def test_one_shout_hardly_changes_what_is_known_to_glow() -> None:
    shout = np.full((ROWS, COLUMNS), 0.999, np.float32)
    assert 0.1 < excess(shout, 0.1) < 0.12
