"""Laws of own examples, own ranges, sliders and suggestions."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from actors import FACE_ON, built_in, shown
from mien.errors import FormatError, InputError
from mien.formats.notes.own import read_pairs
from mien.mapping import JointMapper, Settings
from mien.mapping.held import with_held
from mien.mapping.own import OwnExamples, own_examples
from mien.mapping.ranges import measure_ranges
from mien.mapping.suggest import order, suggest
from mien.numeric.rotation import to_vector
from mien.performance.performance import Performance
from mien.performance.performer import HeldFace

Array = NDArray[np.float64]

HABITS = ("smile", "surprise", "pucker")


def habitual(unseen: Array | None = None) -> tuple[Performance, OwnExamples]:
    """A performer who does three faces half as strongly again and askew, held in turn; then at half
    their strength."""
    character = built_in("woman")
    levels = np.zeros((6, len(character.examples)))
    for row, name in enumerate(HABITS):
        levels[row, character.examples.index(name)] = 1.5
    levels[3:] = 0.5 * levels[:3]
    performance = shown(character, levels, unseen=unseen)
    skew = np.random.default_rng(2).normal(0.0, 1.5, performance.motion[:3].shape)
    motion = performance.motion + np.concatenate([skew, 0.5 * skew])
    along = (motion * performance.unseen[:, None]).sum(axis=-1, keepdims=True)
    performance = replace(performance, motion=motion - along * performance.unseen[:, None])
    pairs = [(performance.time[row], {name: 1.0}) for row, name in enumerate(HABITS)]
    return performance, own_examples(performance, pairs)


@pytest.mark.parametrize("unseen", [None, FACE_ON], ids=["seen in full", "no depth"])
def test_own_examples_are_exact(unseen: Array | None) -> None:
    character = built_in("woman")
    performance, own = habitual(unseen)
    mapper = JointMapper(character, performance, Settings(own=own))
    weights = mapper(performance).weights
    for row, name in enumerate(HABITS):
        wanted = mapper.pieces.key == character.keys.names.index(name)
        assert np.abs(weights[row] - wanted).max() < 1e-8


def test_held_faces_are_exact_for_whom_they_are_meant() -> None:
    performance, own = habitual(FACE_ON)
    closures = np.zeros(2)
    faces = [
        HeldFace("a test", who, pose, own.moments.motion[row], own.moments.unseen[row], closures)
        for row, (who, pose) in enumerate((("woman", {"smile_mouth_L": 0.8}), ("", {"fear": 1.0})))
    ]
    for name, exact in (("woman", True), ("man", False)):
        character = built_in(name)
        mapper = JointMapper(
            character, performance, with_held(Settings(), faces, character, performance)
        )
        first, second = mapper(performance[:2]).weights
        row = mapper.pieces.names.index("smile_mouth_L")
        alone = np.isclose(first[row], 0.8) and np.isclose(np.abs(first).sum(), 0.8)
        assert alone == exact
        wanted = mapper.pieces.key == character.keys.names.index("fear")
        assert np.abs(second - wanted).max() < 1e-8


def test_held_faces_of_another_capture_are_refused() -> None:
    performance, _ = habitual()
    face = HeldFace("other", "", {"smile": 1.0}, np.ones((3, 3)), np.zeros(3), np.zeros(2))
    with pytest.raises(InputError, match="another capture"):
        with_held(Settings(), [face], built_in("woman"), performance)


def test_half_of_an_own_example_is_about_half() -> None:
    character = built_in("woman")
    performance, own = habitual()
    mapper = JointMapper(character, performance, Settings(own=own))
    plain = JointMapper(character, performance)
    found, before = (m.by_key(m(performance).weights[3:]) for m in (mapper, plain))
    wanted = (
        0.5 * np.eye(len(character.examples))[[character.examples.index(name) for name in HABITS]]
    )
    assert np.abs(found - wanted).mean() < 0.5 * np.abs(before - wanted).mean()


def test_rest_stays_rest_with_own_examples() -> None:
    character = built_in("woman")
    performance, own = habitual()
    still = replace(performance, motion=0.0 * performance.motion)
    mapper = JointMapper(character, performance, Settings(own=own))
    assert np.abs(mapper(still).weights).max() < 1e-8


def test_own_examples_must_be_in_the_take_and_the_character() -> None:
    performance, _ = habitual()
    with pytest.raises(InputError, match="no such moment"):
        own_examples(performance, [(99.0, {"smile": 1.0})])
    stranger = own_examples(performance, [(0.0, {"grin": 1.0})])
    with pytest.raises(InputError, match="grin"):
        JointMapper(built_in("woman"), performance, Settings(own=stranger))


@pytest.mark.parametrize("scale", [0.5, 0.7, 1.6])
def test_a_small_mouth_with_its_own_range_is_mapped_as_a_large_one(scale: float) -> None:
    character = built_in("man")
    levels = np.random.default_rng(4).uniform(0.0, 1.0, (60, len(character.examples)))
    levels *= np.random.default_rng(5).random(levels.shape) < 0.2
    performance = shown(character, levels)
    performance = replace(performance, sigma=np.full_like(performance.sigma, 0.2))
    mouth = [p.partition(".")[0] in ("2", "8") for p in performance.points]
    small = performance.motion.copy()
    small[:, mouth] *= scale
    other = replace(performance, motion=small)
    weights = [
        JointMapper(character, take, Settings(ranges=measure_ranges(take)))(take).weights
        for take in (performance, other)
    ]
    assert np.abs(weights[0] - weights[1]).mean() < 0.1 * weights[0].mean()


def test_sliders_move_their_own_region() -> None:
    character = built_in("woman")
    performance = shown(character, 0.5 * np.eye(len(character.examples)))
    plain = JointMapper(character, performance)(performance)
    mapper = JointMapper(character, performance, Settings(mouth=1.4))
    louder = mapper(performance)
    mouth = mapper.pieces.region == 2
    assert louder.weights[:, mouth].sum() > 1.2 * plain.weights[:, mouth].sum()
    brow = mapper.pieces.region == 0
    assert louder.weights[:, brow].sum() == pytest.approx(plain.weights[:, brow].sum(), rel=0.12)


def test_the_head_s_slider_turns_the_head_further() -> None:
    character = built_in("man")
    performance = shown(character, np.zeros((1, len(character.examples))))
    turned = replace(performance, rotation=np.array([[[0.8, 0, 0.6], [0, 1, 0], [-0.6, 0, 0.8]]]))
    plain = JointMapper(character, turned)(turned).rotation
    half = JointMapper(character, turned, Settings(head=0.5))(turned).rotation
    assert np.allclose(to_vector(half), 0.5 * to_vector(plain), atol=1e-9)


def test_sliders_are_bounded() -> None:
    with pytest.raises(InputError, match="brows"):
        Settings(brows=-1.0)


def test_what_explains_most_is_suggested_first() -> None:
    rng = np.random.default_rng(6)
    known, wishes = rng.normal(size=(2, 30)), rng.normal(size=(4, 30))
    motion = rng.uniform(0, 1, (40, 1)) * wishes[2] + 0.2 * rng.uniform(0, 1, (40, 1)) * known[0]
    chosen, errors = order(motion, known, wishes, 3)
    assert chosen[0] == 2
    assert errors[1] < 0.2 * errors[0]
    assert all(after <= before + 1e-3 for before, after in pairwise(errors))


def test_a_missing_key_model_is_found_among_many() -> None:
    woman = built_in("woman")
    poor = replace(woman, examples=tuple(n for n in woman.examples if n not in ("surprise",)))
    take = shown(woman, np.eye(len(woman.examples))[[woman.examples.index("surprise")]])
    found = suggest(poor, [take], woman, ["pucker", "surprise", "blink_left"], 1)
    assert found[0].name == "surprise"
    assert found[0].after < found[0].before


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[[example]]",
        "[[example]]\nseconds = 'x'\npose = {a=1}",
        "[[example]]\nseconds=1\npose=3",
        "[[example]]\nseconds=1\npose={smile=9}",
        "example = 5",
        "[[[",
    ],
)
def test_broken_pairs_are_told(tmp_path: Path, text: str) -> None:
    path = tmp_path / "own.toml"
    path.write_text(text)
    with pytest.raises(FormatError, match=r"own\.toml"):
        read_pairs(path)
