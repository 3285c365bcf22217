"""Each compiled kernel of the curve capture does what plain NumPy does."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from mien.capture.snakes.colour.pigments import Pigments
from mien.capture.snakes.colour.transform import brightness
from mien.capture.snakes.curves.blobs import _extent
from mien.capture.snakes.curves.energy import Terms, descend, energy, packed
from mien.capture.snakes.curves.lens import height
from mien.capture.snakes.curves.settle import _come_to_rest, _reach, _wild
from mien.capture.snakes.head.pose import Pose, fit_pose
from mien.capture.snakes.tongue import _between
from mien.numeric import bezier
from mien.numeric.rotation import from_vector

Array = NDArray[np.float64]
Field = NDArray[np.float32]
SEEDS = range(6)


def some_mask(random: np.random.Generator, share: float) -> NDArray[np.uint8]:
    mask = random.random((random.integers(3, 20), random.integers(3, 30))) < share
    mask[1, 1] = True
    return mask.astype(np.uint8)


@pytest.mark.parametrize("seed", SEEDS)
def test_the_extent_of_a_blob(seed: int) -> None:
    blob = some_mask(np.random.default_rng(seed), 0.2)
    rows, columns = np.nonzero(blob)
    left = np.array([columns.min(), rows[columns <= columns.min() + 1].mean()])
    right = np.array([columns.max(), rows[columns >= columns.max() - 1].mean()])
    x, y = right - left
    below = ((rows - left[1]) * x - (columns - left[0]) * y) / max(np.hypot(x, y), 1.0)
    found = np.concatenate([np.ravel(part) for part in _extent(blob)])
    assert np.allclose(found, [*left, *right, max(-below.min(), 0.5), max(below.max(), 0.5)])


@pytest.mark.parametrize("seed", SEEDS)
def test_what_lies_between_dark_and_teeth(seed: int) -> None:
    random = np.random.default_rng(seed)
    pale, black, teeth = (random.random((3, 12, 15)) < 0.15).astype(np.uint8)
    within = np.ones_like(pale)
    within[random.integers(9, 12) :] = 0
    pale, black = pale & within, black & within
    end = np.flatnonzero(within[:, 0])[-1]
    counted = np.array(
        [
            [
                bool(pale[y, x] and black[: y + 1, x].any() and not teeth[y : end + 1, x].any())
                for x in range(15)
            ]
            for y in range(12)
        ]
    )
    thick = [
        end - np.flatnonzero(black[: np.flatnonzero(column)[0] + 1, x])[-1]
        for x, column in enumerate(counted.T)
        if column.any()
    ]
    assert counted.any()
    assert _between(pale, black, teeth, within) == (counted.sum(), pytest.approx(np.mean(thick)))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_curve_of_least_squares(seed: int) -> None:
    places = np.cumsum(np.random.default_rng(seed).uniform(-1.0, 2.0, (15, 2)), axis=0)
    length = np.linalg.norm(np.diff(places, axis=0), axis=1)
    at = np.concatenate([[0.0], np.cumsum(length)]) / length.sum()
    share = bezier.bernstein(at)
    rest = places - share[:, [0, 3]] @ places[[0, -1]]
    inner = np.linalg.lstsq(share[:, 1:3], rest, rcond=None)[0]
    assert np.allclose(bezier.fit(places), np.vstack([places[0], inner, places[-1]]))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_pose_is_that_of_weighted_least_squares(seed: int) -> None:
    random = np.random.default_rng(seed)
    rest = random.normal(0.0, 30.0, (40, 3))
    start = Pose(from_vector(random.normal(0.0, 0.1, 3)), 1.0, random.normal(0.0, 2.0, 2))
    moved = Pose(from_vector(random.normal(0.0, 0.2, 3)), 1.05, np.array([3.0, -2.0]))
    seen = moved(rest) + random.normal(0.0, 1.0, (40, 2))
    points = rest, seen, random.uniform(0.5, 6.0, 40), random.uniform(3.0, 15.0, 40)
    found, twin = fit_pose(*points, start), plain_pose(*points, start)
    assert np.allclose(found.rotation, twin.rotation, atol=1e-9)
    assert found.scale == pytest.approx(twin.scale)
    assert np.allclose(found.shift, twin.shift)


def plain_pose(rest: Array, seen: Array, weight: Array, knee: Array, start: Pose) -> Pose:
    """Four rounds of Gauss and Newton; Cauchy weights, and 50 squared units a squared radian
    against turning."""
    rotation, scale, shift, total = start.rotation, start.scale, start.shift, np.zeros(3)
    for _ in range(4):
        x, y, z = (rest @ rotation.T).T
        miss = seen - scale * np.stack([x, y], axis=1) - shift
        trust = np.repeat(weight / (1.0 + (miss**2).sum(axis=1) / knee**2), 2)
        none, one = np.zeros_like(x), np.ones_like(x)
        rows = np.stack(
            [
                np.stack([none, scale * z, -scale * y, x, one, none], axis=1),
                np.stack([-scale * z, none, scale * x, y, none, one], axis=1),
            ],
            axis=1,
        ).reshape(-1, 6)
        stiff = np.diag([50.0, 50.0, 0.0, 0.0, 0.0, 0.0])
        right = rows.T @ (trust * miss.ravel()) - stiff @ np.concatenate([total, np.zeros(3)])
        step = np.linalg.solve((rows * trust[:, None]).T @ rows + stiff, right)
        total = total + step[:3]
        rotation = from_vector(step[:3]) @ rotation
        scale, shift = scale + float(step[3]), shift + step[4:]
    return Pose(rotation, scale, shift)


@pytest.mark.parametrize("seed", SEEDS)
def test_brightness_and_the_nearest_pixels(seed: int) -> None:
    random = np.random.default_rng(seed)
    patch = random.integers(0, 256, (12, 17, 3), dtype=np.uint8)
    gains = random.uniform(0.5, 3.0, 3)
    wanted = np.minimum((patch * gains).max(axis=2), 512.0)
    value = brightness(patch, gains)
    assert np.allclose(value, wanted, rtol=1e-5)
    seen = Pigments(value, value, value, np.array([-3.0, 2.0]), 2)
    places = random.uniform(-8.0, 40.0, (5, 4, 2))
    at = np.rint((places - seen.corner) / 2).astype(int)
    nearest = value[np.clip(at[..., 1], 0, 11), np.clip(at[..., 0], 0, 16)]
    assert np.array_equal(seen.values(value, places), nearest)


LIMITS = np.array([0.1, 20.0, 30.0, 100.0, 20.0])
"""Least contrast, farthest, tallest, widest, narrowest."""


@pytest.mark.parametrize("seed", range(24))
def test_what_no_feature_can_be(seed: int) -> None:
    random = np.random.default_rng(seed)
    rest = np.array([[-30, 0], [30, 0], [-10, -8], [10, -8], [-10, 8], [10, 8]], dtype=float)
    lens = random.uniform(0.3, 1.8) * rest @ from_vector(
        np.array([0.0, 0.0, random.normal(0.0, 0.5)])
    )[:2, :2] + random.normal(0.0, 12.0, 2)
    chord = lens[1] - lens[0]
    wide = np.linalg.norm(chord)
    upper, lower = (bezier.curve(lens[[0, *middle, 1]], 21) for middle in ((2, 3), (4, 5)))
    down = np.array([-chord[1], chord[0]]) / wide
    tall = float(((lower - upper) @ down).max())
    wild = (
        np.linalg.norm((lens - rest).mean(axis=0)) > 20.0
        or tall > 30.0
        or not 20.0 <= wide <= 100.0
        or chord[0] / wide < np.cos(np.radians(35.0))
    )
    assert _wild(lens, rest, LIMITS) == wild
    assert _reach(lens.reshape(12)) == pytest.approx(min(max(0.2 * tall, 1.2), 6.0))


@pytest.mark.parametrize("seed", SEEDS)
def test_the_descent(seed: int) -> None:
    random = np.random.default_rng(seed)
    field = random.random((30, 40)).astype(np.float32)
    lens = np.array([[8, 15], [32, 15], [15, 8], [25, 8], [15, 22], [25, 22]], dtype=float)
    prior = 0.01 * np.eye(12), 0.01 * lens.reshape(12)
    place, value = descend(lens.reshape(12), field, np.zeros(2), packed(Terms()), *prior, 6, 1.0)
    wanted, least = plain_descent(lens, field, Terms(), prior, 6, 1.0)
    assert np.allclose(place, wanted.reshape(12), atol=1e-6)
    assert value == pytest.approx(least)


Prior = tuple[Array, Array]


def plain_descent(
    lens: Array, field: Field, terms: Terms, prior: Prior, steps: int, step: float
) -> tuple[Array, float]:
    value, slope = energy(lens, field, np.zeros(2), terms, *prior)
    for _ in range(steps):
        trial = lens - step / np.abs(slope).max() * slope
        there, ahead = energy(trial, field, np.zeros(2), terms, *prior)
        if there < value:
            lens, value, slope, step = trial, there, ahead, 1.3 * step
        else:
            step *= 0.5
            if step < 0.02:
                break
    return lens, value


@pytest.mark.parametrize("seed", SEEDS)
def test_where_curves_come_to_rest(seed: int) -> None:
    random = np.random.default_rng(seed)
    sharp = random.random((30, 40)).astype(np.float32)
    fields = [cv2.GaussianBlur(sharp, (0, 0), sigma) for sigma in (3.0, 1.5, 0.8)]
    lens = np.array([[8, 15], [32, 15], [15, 8], [25, 8], [15, 22], [25, 22]], dtype=float)
    starts = lens + random.normal(0.0, 2.0, (3, 6, 2))
    prior = 0.01 * np.eye(12), 0.01 * lens.reshape(12)
    limits = np.array([random.normal(0.0, 0.02), 20.0, 30.0, 100.0, 20.0])
    terms = Terms(least_width=30.0)
    place, value, across, lost = _come_to_rest(
        starts.reshape(3, 12), tuple(fields), np.zeros(2), packed(terms), *prior, lens, limits
    )
    wanted, least = plain_rest(starts, fields, terms, prior)
    bare = Terms(edge=0.0, reach=plain_reach(wanted))
    nothing = np.zeros((12, 12)), np.zeros(12)
    contrast = -energy(wanted, fields[1], np.zeros(2), bare, *nothing)[0]
    assert np.allclose(place, wanted.reshape(12), atol=1e-6)
    assert value == pytest.approx(least)
    assert across == pytest.approx(contrast)
    assert lost == (contrast < limits[0] or _wild(wanted, lens, limits))


def plain_rest(
    starts: Array, fields: list[Field], terms: Terms, prior: Prior
) -> tuple[Array, float]:
    """The best of several descents on the coarse field, brought to rest on the finer ones."""

    def fallen(lens: Array, field: Field, steps: int, step: float) -> tuple[Array, float]:
        return plain_descent(
            lens, field, replace(terms, reach=plain_reach(lens)), prior, steps, step
        )

    coarse, middle, fine = fields
    best, _ = min((fallen(lens, coarse, 8, 2.0) for lens in starts), key=lambda found: found[1])
    best, _ = fallen(best, middle, 6, 1.0)
    return fallen(best, fine, 8, 1.0)


def plain_reach(lens: Array) -> float:
    """A fifth of a lens's height, within bounds."""
    return float(np.clip(0.2 * height(lens), 1.2, 6.0))
