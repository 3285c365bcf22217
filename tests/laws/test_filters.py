"""Laws of smoothing: still when still, quick when quick, without lag, live as offline."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mien.numeric.one_euro import OneEuro, filter_both_ways, filter_forward
from mien.numeric.rotation import angle_between, from_vector
from mien.performance.curves import Curves
from mien.performance.filters import Smoother, smooth

Array = NDArray[np.float64]
Filter = Callable[[Curves], Curves]

BLINK = np.array([0.2, 0.7, 1.0, 0.9, 0.6, 0.3, 0.1])
"""A blink of a quarter second at 30 frames a second."""


def causal(take: Curves) -> Curves:
    return Smoother()(take)


def curves(weights: Array, time: Array | None = None, lost: Array | None = None) -> Curves:
    frames = len(weights)
    return Curves(
        character="someone",
        names=tuple(f"piece_{i}" for i in range(weights.shape[1])),
        time=np.arange(frames) / 30.0 if time is None else time,
        weights=weights,
        rotation=np.tile(np.eye(3), (frames, 1, 1)),
        translation=np.zeros((frames, 3)),
        gaze=np.zeros((frames, 2, 2)),
        lost=np.zeros(frames, dtype=bool) if lost is None else lost,
        residual=np.zeros(frames),
    )


def plain_one_euro(values: Array, time: Array, setting: OneEuro) -> Array:
    """The filter as its paper writes it, for (F, G, D)."""

    def keep(cutoff: Array | float, step: float) -> Array | float:
        return 1.0 / (1.0 + 1.0 / (2.0 * np.pi * cutoff * step))

    slope, result, out = np.zeros_like(values[0]), values[0], [values[0]]
    for i in range(1, len(values)):
        step = time[i] - time[i - 1]
        new = (values[i] - values[i - 1]) / step
        slope = slope + keep(setting.slope_cutoff, step) * (new - slope)
        speed = np.linalg.norm(slope, axis=-1, keepdims=True)
        result = result + keep(setting.cutoff + setting.beta * speed, step) * (values[i] - result)
        out.append(result)
    return np.array(out)


@pytest.fixture
def wandering() -> Curves:
    rng = np.random.default_rng(0)
    walk = np.cumsum(rng.normal(0, 0.05, (120, 4)), axis=0)
    turn = np.cumsum(rng.normal(0, 0.02, (120, 3)), axis=0)
    time = np.cumsum(rng.uniform(0.02, 0.06, 120))
    lost = np.zeros(120, dtype=bool)
    lost[40:80] = True
    return replace(
        curves(walk, time, lost), rotation=from_vector(turn), gaze=walk.reshape(120, 2, 2)
    )


def test_the_kernel_is_the_paper() -> None:
    rng = np.random.default_rng(1)
    values, time = rng.normal(size=(80, 5, 3)), np.cumsum(rng.uniform(0.01, 0.1, 80))
    for setting in (OneEuro(1.0, 0.0), OneEuro(0.5, 3.0, 2.0)):
        ours, _ = filter_forward(values, time, setting)
        assert np.abs(ours - plain_one_euro(values, time, setting)).max() < 1e-12


def test_a_still_face_stays_as_it_is() -> None:
    still = curves(np.full((60, 3), 0.4))
    assert smooth(still).weights == pytest.approx(0.4, abs=1e-12)
    assert causal(still).weights == pytest.approx(0.4, abs=1e-12)


@pytest.mark.parametrize(("filtered", "left"), [(smooth, 0.4), (causal, 0.45)])
def test_tremble_goes(filtered: Filter, left: float) -> None:
    noise = np.random.default_rng(2).normal(0, 0.01, (300, 5))
    assert filtered(curves(noise)).weights[30:].std() < left * noise.std()


@pytest.mark.parametrize(("filtered", "late"), [(smooth, 0), (causal, 1)])
@pytest.mark.parametrize("height", [0.6, 1.0])
def test_a_blink_keeps_its_peak_and_its_time(filtered: Filter, late: int, height: float) -> None:
    weights = np.zeros((60, 1))
    weights[30:37, 0] = height * BLINK
    after = filtered(curves(weights)).weights[:, 0]
    assert after.max() > 0.85 * height
    assert 32 <= after.argmax() <= 32 + late


def test_both_ways_has_no_lag() -> None:
    hump = np.exp(-(((np.arange(121) - 60) / 12.0) ** 2))
    after = filter_both_ways(hump[:, None, None], np.arange(121) / 30.0, OneEuro(1.0, 5.0, 3.0))
    forward, _ = filter_forward(hump[:, None, None], np.arange(121) / 30.0, OneEuro(1.0, 5.0, 3.0))
    assert abs(float(np.argmax(after)) - 60) <= 1
    rising = slice(40, 60)
    assert (
        np.abs(after[rising, 0, 0] - hump[rising]).max()
        < np.abs(forward[rising, 0, 0] - hump[rising]).max()
    )


def test_frames_smooth_alone_as_in_a_take(wandering: Curves) -> None:
    whole = causal(wandering)
    live = Smoother()
    for i in range(len(wandering)):
        one = live(_part(wandering, slice(i, i + 1)))
        for name in ("weights", "rotation", "translation", "gaze"):
            assert np.abs(getattr(one, name)[0] - getattr(whole, name)[i]).max() < 1e-9


def test_a_cast_smooths_as_each_of_it_alone(wandering: Curves) -> None:
    other = replace(
        wandering, weights=wandering.weights[:, :1] ** 2, translation=np.full((120, 3), 4.0)
    )
    live = Smoother()
    halves = [
        live.together([_part(c, part) for c in (wandering, other)])
        for part in (slice(0, 50), slice(50, 120))
    ]
    for number, alone in enumerate((causal(wandering), causal(other))):
        for name in ("weights", "rotation", "translation", "gaze"):
            whole = np.concatenate([getattr(half[number], name) for half in halves])
            assert np.abs(whole - getattr(alone, name)).max() < 1e-12


def _part(take: Curves, part: slice) -> Curves:
    per_frame = [field.name for field in fields(Curves) if field.name not in ("character", "names")]
    return replace(take, **{name: getattr(take, name)[part] for name in per_frame})


def test_the_rate_of_the_film_does_not_matter() -> None:
    """Twice the frames, or every other frame twice as late: the same curve."""
    for fine in (np.arange(0, 4, 1 / 120), np.sort(np.random.default_rng(4).uniform(0, 4, 480))):
        coarse = np.arange(0, 4, 1 / 60)
        wave = [(0.5 + 0.4 * np.sin(2.0 * t))[:, None] for t in (fine, coarse)]
        dense, sparse = (
            smooth(curves(w, t)).weights[:, 0] for w, t in zip(wave, (fine, coarse), strict=True)
        )
        inner = (coarse > 0.5) & (coarse < 3.5)
        assert np.abs(np.interp(coarse, fine, dense) - sparse)[inner].max() < 0.02


def test_rotations_stay_rotations_and_turn_as_they_did() -> None:
    turn = np.zeros((90, 3))
    turn[:, 1] = np.radians(40) * np.sin(np.arange(90) / 15.0)
    nodding = replace(curves(np.zeros((90, 1))), rotation=from_vector(turn))
    after = smooth(nodding).rotation
    assert np.abs(after @ np.swapaxes(after, 1, 2) - np.eye(3)).max() < 1e-9
    assert np.degrees(angle_between(after, nodding.rotation)).max() < 3.0


@pytest.mark.parametrize("filtered", [smooth, causal])
def test_a_lost_face_holds_then_rests_then_returns(filtered: Filter) -> None:
    lost = np.zeros(150, dtype=bool)
    lost[30:36] = True
    lost[60:110] = True
    gone = replace(curves(np.full((150, 2), 0.8), lost=lost), translation=np.full((150, 3), 9.0))
    after = filtered(gone)
    assert after.weights[:66] == pytest.approx(0.8)
    assert np.abs(after.weights[100:110]).max() == 0.0
    assert np.abs(after.translation[100:110]).max() == 0.0
    assert after.weights[125:] == pytest.approx(0.8)
    assert np.abs(np.diff(after.weights[:, 0])).max() < 0.15
