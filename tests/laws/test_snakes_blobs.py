"""Blobs, and the irises: each compiled kernel does what OpenCV and plain NumPy do."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from mien.capture.snakes.curves.blobs import find_blob, threshold, without_hair
from mien.capture.snakes.curves.lens import boxed
from mien.capture.snakes.head.patch import ORIGIN
from mien.capture.snakes.iris import _ACROSS, _DOWN, _PATTERN, fit_iris

Array = NDArray[np.float64]
Field = NDArray[np.float32]
SEEDS = range(6)


def some_field(random: np.random.Generator) -> Field:
    """(29, 50) soft spots, 0..1."""
    noise = cv2.GaussianBlur(random.random((29, 50)).astype(np.float32), (0, 0), 2.0)
    return np.asarray((noise - noise.min()) / (noise.max() - noise.min()))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_threshold_is_otsus(seed: int) -> None:
    random = np.random.default_rng(seed)
    field = some_field(random) ** random.uniform(0.5, 2.0)
    parted, _ = cv2.threshold((field * 255.0).astype(np.uint8), 0, 255, cv2.THRESH_OTSU)
    assert threshold(field) == pytest.approx(np.clip(parted / 255.0, 0.3, 0.7))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_likeliest_blob(seed: int) -> None:
    random = np.random.default_rng(seed)
    field, expected = some_field(random), random.uniform(0.0, 1.0, 2) * (50.0, 29.0)
    level = threshold(field)
    mask = cv2.morphologyEx(
        (field > level).astype(np.uint8), cv2.MORPH_CLOSE, np.ones((3, 3), np.uint8)
    )
    _, label, facts, middle = cv2.connectedComponentsWithStats(mask, connectivity=4)
    area = 4.0 * facts[:, cv2.CC_STAT_AREA]
    worth = area * np.exp(-4.0 * ((middle - expected) ** 2).sum(axis=1) / (2.0 * 25.0**2))
    wanted = [
        label == blob
        for blob in np.argsort(-worth[1:]) + 1
        if area[blob] >= 20 and (field[label == blob] > level + 0.15).any()
    ]
    found = find_blob(field, expected, 2.0)
    assert (found is None) == (not wanted)
    assert found is None or np.array_equal(found, wanted[0])


def test_no_blob_where_nothing_stands_out() -> None:
    assert find_blob(np.zeros((29, 50), np.float32), np.array([25.0, 15.0]), 2.0) is None


@pytest.mark.parametrize("seed", SEEDS)
def test_hair_is_what_hangs_in_from_the_rim(seed: int) -> None:
    random = np.random.default_rng(seed)
    field, expected = some_field(random), np.array([25.0, 15.0])
    _, label, facts, _ = cv2.connectedComponentsWithStats(
        (field > 0.5).astype(np.uint8), connectivity=4
    )
    left, top, width, height, _ = facts.T
    hanging = ((left == 0) | (left + width == 50) | (top == 0)) & (2 * height > 24)
    hanging &= ~((left < expected[0]) & (left + width > expected[0]))
    hanging[0] = False
    assert np.array_equal(without_hair(field, expected), np.where(hanging[label], 0.0, field))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_lens_between_two_ends(seed: int) -> None:
    random = np.random.default_rng(seed)
    left, right = random.uniform(-30.0, 0.0, 2), random.uniform(10.0, 40.0, 2)
    top, bottom = random.uniform(0.5, 20.0, 2)
    chord = right - left
    width = np.linalg.norm(chord)
    down = np.array([-chord[1], chord[0]]) / width
    inset = 0.25 * np.clip(2.0 - (top + bottom) / (0.35 * width), 0.0, 1.0)
    inner = left + inset * chord, right - inset * chord
    upper = [place - 4.0 / 3.0 * top * down for place in inner]
    lower = [place + 4.0 / 3.0 * bottom * down for place in inner]
    assert np.allclose(boxed(left, right, top, bottom), [left, right, *upper, *lower])


@pytest.mark.parametrize("middle", [(-50.0, 0.0), (51.3, -2.7), (-108.0, -71.0)])
def test_how_well_an_iris_fits(middle: tuple[float, float]) -> None:
    random = np.random.default_rng(5)
    value, mean = (random.uniform(0.0, 400.0, (132, 112)).astype(np.float32) for _ in range(2))
    dark = np.clip(np.log(np.maximum(mean, 1.0) / np.maximum(value, 1.0)), 0.0, 1.2)
    rim = len(_PATTERN) // 2 + 20
    dark = np.pad(dark, rim, mode="edge")
    whole = cv2.filter2D(dark, cv2.CV_64F, _PATTERN.astype(float), borderType=cv2.BORDER_REPLICATE)
    x = (middle[0] + _ACROSS + ORIGIN[0] - 0.5) / 2.0 + rim
    y = ((middle[1] + _DOWN + ORIGIN[1] - 0.5) / 2.0 + rim)[:, None]
    j, i, fy, fx = y.astype(int), x.astype(int), y % 1.0, x % 1.0
    upper = whole[j, i] * (1.0 - fx) + whole[j, i + 1] * fx
    lower = whole[j + 1, i] * (1.0 - fx) + whole[j + 1, i + 1] * fx
    found = fit_iris(value, mean, np.array(middle))
    assert np.allclose(found, upper * (1.0 - fy) + lower * fy, atol=1e-5)
