"""Laws of the default mapper on the built-in characters, at gain 1 and before lids are mixed; a
key model's weight is the mean of its pieces."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize import lsq_linear

from actors import FACE_ON, built_in, shown
from mien.errors import InputError
from mien.face.character import Character
from mien.face.library import CHARACTERS
from mien.mapping import MAPPERS, JointMapper, Settings
from mien.numeric.qp import solve_boxes

Array = NDArray[np.float64]

EXACT = Settings(ridge=0.0, linear_ridge=0.0, thrift=0.0)


@pytest.fixture(params=CHARACTERS, scope="module")
def character(request: pytest.FixtureRequest) -> Character:
    return built_in(request.param)


@pytest.fixture(params=[None, FACE_ON], ids=["seen in full", "no depth"])
def unseen(request: pytest.FixtureRequest) -> Array | None:
    return request.param


def one_of_each(character: Character) -> Array:
    return np.eye(len(character.examples))


@pytest.mark.parametrize(("settings", "within"), [(EXACT, 1e-6), (Settings(), 0.1)])
def test_cardinal_weights_are_one_hot_at_every_example(
    character: Character, settings: Settings, within: float
) -> None:
    wanted = one_of_each(character)
    performance = shown(character, wanted)
    mapper = JointMapper(character, performance, settings)
    weights = mapper.by_key(mapper.cardinal_weights(performance))
    assert np.abs(weights - wanted).max() < within


def test_without_ridge_and_thrift_the_programme_is_one_hot_too(character: Character) -> None:
    wanted = one_of_each(character)
    performance = shown(character, wanted)
    weights = JointMapper(character, performance, EXACT).key_weights(performance)
    assert np.abs(weights - wanted).max() < 1e-4


def test_a_whole_key_model_is_shown_nearly_whole(character: Character) -> None:
    performance = shown(character, one_of_each(character))
    weights = JointMapper(character, performance).key_weights(performance)
    assert np.diag(weights).min() > 0.8
    assert np.abs(weights - np.diag(np.diag(weights))).max() < 0.1


@pytest.mark.parametrize("mapping", MAPPERS)
def test_neutral_is_nothing(character: Character, mapping: str, unseen: Array | None) -> None:
    performance = shown(character, np.zeros((1, len(character.examples))), unseen=unseen)
    mapper = MAPPERS[mapping](character, performance, Settings())
    assert np.abs(mapper(performance).weights).max() < 1e-9
    assert mapper(performance).residual == pytest.approx(0.0)


def test_half_an_example_is_half_its_own_key_model(
    character: Character, unseen: Array | None
) -> None:
    performance = shown(character, 0.5 * one_of_each(character), unseen=unseen)
    weights = JointMapper(character, performance).key_weights(performance)
    own = np.diag(weights)
    assert own.min() > 0.3
    assert own.max() < 0.65
    assert (weights - np.diag(own)).max() < 0.25


def test_noise_hardly_moves_the_skin(character: Character, unseen: Array | None) -> None:
    still = np.zeros((100, len(character.examples)))
    places = shown(character, still).motion.shape
    noise = np.random.default_rng(0).normal(0.0, 1.0, places)
    performance = shown(character, still, unseen=unseen, noise=noise)
    mapper = JointMapper(character, performance)
    skin = character.face.part("skin")
    fields = mapper.pieces.displacements[:, skin.first : skin.last]
    motion = np.tensordot(mapper(performance).weights, fields, axes=1)
    assert np.linalg.norm(motion, axis=-1).mean() < 0.3


def test_weights_stay_within_their_bounds(character: Character) -> None:
    performance = shown(character, 3.0 * one_of_each(character))
    for gain, most in ((1.0, 1.15), (2.0, 2.3)):
        mapper = JointMapper(character, performance, Settings(gain=gain))
        weights = mapper(performance).weights
        assert weights.min() >= 0.0
        assert 1.1 < weights.max() <= most + 1e-9


def test_a_gain_exaggerates_and_one_changes_nothing(character: Character) -> None:
    performance = shown(character, 0.5 * one_of_each(character))
    plain = JointMapper(character, performance)(performance).weights
    same = JointMapper(character, performance, Settings(gain=1.0))(performance).weights
    more = JointMapper(character, performance, Settings(gain=2.0))(performance).weights
    whole = shown(character, one_of_each(character))
    assert (plain == same).all()
    assert np.abs(more - JointMapper(character, whole)(whole).weights).max() < 1e-9


@pytest.mark.parametrize("gain", [-1.0, 11.0, float("nan")])
def test_a_gain_that_makes_no_sense_is_refused(gain: float) -> None:
    with pytest.raises(InputError, match="gain"):
        Settings(gain=gain)


def test_a_brow_raised_alone_leaves_the_rest_alone(character: Character) -> None:
    performance = shown(character, one_of_each(character))
    mapper = JointMapper(character, performance)
    left_brow = [fdp in ("4.1", "4.3", "4.5") for fdp in performance.points]
    brows_up = performance.motion[[character.examples.index("brows_up")]]
    motion = np.where(np.array(left_brow)[None, :, None], brows_up, 0.0)
    one = shown(character, np.zeros((1, len(character.examples))), noise=motion)
    weights = dict(zip(mapper.pieces.names, mapper(one).weights[0], strict=True))
    raised = sum(weight for name, weight in weights.items() if name.endswith("brow_L"))
    assert raised > 0.5
    assert sum(weight for name, weight in weights.items() if name.endswith("_R")) < 0.3 * raised
    assert sum(weight for name, weight in weights.items() if "mouth" in name) < 0.2 * raised


def test_the_programmes_are_solved() -> None:
    rng = np.random.default_rng(1)
    rows, right = rng.normal(size=(20, 40, 12)), rng.normal(size=(20, 40)) * 3
    hessians = np.swapaxes(rows, 1, 2) @ rows
    linear = -np.einsum("frw,fr->fw", rows, right)
    lower, upper = np.zeros(12), np.full(12, 0.3)
    ours = solve_boxes(hessians, linear, lower, upper)
    for weights, a, b in zip(ours, rows, right, strict=True):
        assert weights == pytest.approx(lsq_linear(a, b, (0.0, 0.3), "bvls").x, abs=1e-7)
    shared = solve_boxes(hessians[:1], linear, lower, upper)
    alone = np.concatenate([solve_boxes(hessians[:1], f[None], lower, upper) for f in linear])
    assert np.abs(shared - alone).max() < 1e-9
