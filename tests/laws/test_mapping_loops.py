"""The mapper's loops against their twins in array operations."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from mien.mapping.joint import _unexpressed
from mien.mapping.lids import Lids
from mien.mapping.programme import _add_to_diagonals, _belief
from mien.mapping.sight import Sight, seen

SEEDS = st.integers(0, 10_000)


def mix(lids: Lids, weights: np.ndarray, closure: np.ndarray) -> np.ndarray:
    """Lids.mix, all frames and both eyes at once."""
    weights = weights * (1.0 - lids.blink.any(axis=0))
    wanted = (1.0 - np.minimum(closure, 1.0)) * lids.opening
    opened = lids.opening + weights @ lids.effect.T
    excess = np.maximum(opened - wanted, 0.0)
    widened = weights @ (lids.effect * lids.widens).T
    back = np.minimum(excess / np.maximum(widened, 1e-9), 1.0)
    shut = np.minimum(excess / np.maximum(opened, 1e-9), 1.0)
    weights = weights * (1.0 - back @ lids.widens - shut @ lids.narrows)
    missing = lids.opening + weights @ lids.effect.T - wanted
    level = np.clip(missing / -(lids.effect * lids.blink).sum(axis=1), 0.0, 2.0)
    return weights + level @ lids.blink


@settings(max_examples=30, deadline=None)
@given(SEEDS)
def test_lids_are_mixed_as_their_twin_mixes_them(seed: int) -> None:
    random = np.random.default_rng(seed)
    kind, eye = random.integers(0, 4, 12), random.integers(0, 2, 12)
    kind[:2], eye[:2] = 1, (0, 1)
    mine = eye == np.array([[0], [1]])
    blink, widens, narrows = (mine & (kind == which) for which in (1, 2, 3))
    size = random.uniform(0.1, 9.0, 12) * np.where(kind == 2, 1.0, -1.0)
    effect = size * np.where(mine, 1.0, 0.05)
    lids = Lids(blink, random.uniform(5.0, 12.0, 2), effect, widens, narrows)
    weights, closure = random.uniform(0, 1, (6, 12)), random.uniform(-0.5, 1.3, (6, 2))
    before = weights.copy()
    np.testing.assert_allclose(
        lids.mix(weights, closure), mix(lids, weights, closure), rtol=1e-12, atol=1e-12
    )
    np.testing.assert_array_equal(weights, before)


@settings(max_examples=30, deadline=None)
@given(SEEDS)
def test_what_is_left_and_believed_is_what_the_twins_have(seed: int) -> None:
    random = np.random.default_rng(seed)
    motion, shown = random.normal(size=(2, 5, 9, 3))
    unseen = random.normal(size=(5, 3))
    unseen /= np.linalg.norm(unseen, axis=1, keepdims=True)
    unseen[0] = 0.0
    left = (motion - shown)[:, :7]
    square = (left**2).sum(axis=-1) - (left * unseen[:, None]).sum(axis=-1) ** 2
    np.testing.assert_allclose(
        _unexpressed(motion, shown, unseen, 7), np.sqrt(square.mean(axis=1)), rtol=1e-9
    )
    turn = np.arccos(np.abs(unseen[1:, 2]))
    told = 1.0 / (1.0 + (turn / np.radians(25.0)) ** 2)
    np.testing.assert_allclose(_belief(unseen), [1.0, *told], rtol=1e-12)
    matrices = random.normal(size=(2, 4, 4))
    wanted = matrices + np.array([1.0, 2.0])[:, None, None] * np.eye(4)
    _add_to_diagonals(matrices, np.array([1.0, 2.0]))
    np.testing.assert_allclose(matrices, wanted)


@settings(max_examples=20, deadline=None)
@given(SEEDS)
def test_products_of_what_is_seen_are_those_of_projected_motions(seed: int) -> None:
    random = np.random.default_rng(seed)
    motions, precision = random.normal(size=(4, 6, 3)), random.uniform(0, 3, (6, 3))
    unseen = random.normal(size=(3, 3))
    unseen /= np.linalg.norm(unseen, axis=1, keepdims=True)
    sight = seen(unseen)
    shown = np.einsum("wqx,fxy->fwqy", motions, sight)
    wanted = np.einsum("fwqx,qx,fvqx->fwv", shown, precision, shown)
    np.testing.assert_allclose(Sight(motions, precision).gram(sight), wanted, atol=1e-9)
