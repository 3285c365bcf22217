"""Laws of mapping as a whole: one frame at a time, mirrors, sizes, depth, lids, examples."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields, replace

import numpy as np
import pytest
from numpy.typing import NDArray

from actors import FACE_ON, built_in, mirrored, shown
from mien.errors import InputError
from mien.face.character import Character
from mien.face.library import CHARACTERS
from mien.mapping import MAPPERS, JointMapper, Settings
from mien.performance.acted import acted
from mien.performance.performance import Performance

Array = NDArray[np.float64]


@pytest.fixture(scope="module")
def man() -> Character:
    return built_in("man")


def mixed(character: Character, frames: int = 12, **options: object) -> Performance:
    """Several key models at once, the head turned this way and that."""
    rng = np.random.default_rng(7)
    weights = rng.uniform(0, 0.6, (frames, len(character.examples)))
    weights *= rng.random(weights.shape) < 0.3
    turn = np.linspace(-0.6, 0.6, frames)
    unseen = np.stack([np.sin(turn), np.zeros(frames), np.cos(turn)], axis=-1)
    return shown(character, weights, unseen=unseen, **options)  # type: ignore[arg-type]


def frame(performance: Performance, i: int) -> Performance:
    """One frame as a performance of its own."""
    per_frame = {
        field.name: getattr(performance, field.name)[i : i + 1]
        for field in fields(performance)
        if field.name
        in ("time", "motion", "rotation", "translation", "gaze", "confidence", "lost", "unseen")
    }
    scalars = {name: values[i : i + 1] for name, values in performance.scalars.items()}
    return replace(performance, **per_frame, scalars=scalars)


@pytest.mark.parametrize("mapping", MAPPERS)
@pytest.mark.parametrize("lids", [False, True])
def test_frames_map_alone_as_in_a_take(man: Character, mapping: str, lids: bool) -> None:
    shut = np.linspace(0, 1, 150)
    scalars = {"lid_left": shut, "lid_right": shut[::-1]} if lids else None
    take = mixed(man, 150, scalars=scalars)
    mapper = MAPPERS[mapping](man, take, Settings())
    whole = mapper(take)
    for i in (0, 63, 128, 149):
        one = mapper(frame(take, i))
        assert np.abs(one.weights[0] - whole.weights[i]).max() < 1e-6
        assert one.residual[0] == pytest.approx(whole.residual[i], abs=1e-6)


def test_threads_do_not_meet(man: Character) -> None:
    take = mixed(man, 60)
    mapper = JointMapper(man, take)
    alone = mapper(take).weights
    with ThreadPoolExecutor(4) as pool:
        for curves in pool.map(mapper, [take] * 12):
            assert (curves.weights == alone).all()


@pytest.mark.parametrize("name", CHARACTERS)
def test_a_mirrored_performance_gives_mirrored_weights(name: str) -> None:
    character = built_in(name)
    shut = np.linspace(0, 1, 12)
    take = mixed(character, scalars={"lid_left": shut, "lid_right": shut**2})
    mapper = JointMapper(character, take)
    there = mapper(take).weights
    image = mirrored(take)
    back = JointMapper(character, image)(image).weights[:, mapper.pieces.mirrored()]
    assert np.abs(there - back).max() < 0.02


def test_the_size_of_the_performer_does_not_matter(man: Character) -> None:
    small, large = mixed(man), mixed(man, size=1.7)
    same = JointMapper(man, small)(small).weights - JointMapper(man, large)(large).weights
    assert np.abs(same).max() < 1e-6


def test_what_the_camera_cannot_see_does_not_count(man: Character) -> None:
    take = mixed(man)
    depth = np.random.default_rng(2).normal(0, 5, take.motion.shape[:2])
    deeper = replace(take, motion=take.motion + depth[..., None] * take.unseen[:, None])
    mapper = JointMapper(man, take)
    assert np.abs(mapper(take).weights - mapper(deeper).weights).max() < 1e-6


def test_what_no_key_model_shows_is_the_residual(man: Character) -> None:
    still = np.zeros((1, len(man.examples)))
    points = shown(man, still).points
    odd = np.zeros((1, len(points), 3))
    odd[0, points.index("9.3")] = (0.0, 8.0, 0.0)
    strange = shown(man, still, noise=odd)
    curves = JointMapper(man, strange)(strange)
    assert curves.residual[0] == pytest.approx(8.0 / np.sqrt(len(points)), rel=0.1)
    assert curves.weights.max() < 0.1


def test_head_and_eyes_pass_through(man: Character) -> None:
    take = mixed(man)
    gaze = np.random.default_rng(0).normal(0, 0.2, take.gaze.shape)
    take = replace(take, gaze=gaze, translation=take.translation + np.ones(3))
    curves = JointMapper(man, take)(take)
    assert (curves.gaze == gaze).all()
    assert (curves.translation == take.head()[1]).all()
    assert curves.names == JointMapper(man, take).pieces.names


def openings(mapper: JointMapper, weights: Array) -> Array:
    """(F, 2) mm each eye is open, from the vertices."""
    face = mapper.character.face
    upper, lower = face.points.index(["3.1", "3.2"]), face.points.index(["3.3", "3.4"])
    at_points = face.points.at(mapper.pieces.displacements.astype(float))[..., 1]
    height = face.points.at(face.vertices)[:, 1] + weights @ at_points
    return np.asarray(height[:, upper] - height[:, lower])


@pytest.mark.parametrize("name", CHARACTERS)
@pytest.mark.parametrize("key", [None, "surprise", "smile"])
def test_the_lid_follows_the_performers_lid(name: str, key: str | None) -> None:
    """... whatever else moves it, unless that alone shuts it further."""
    character = built_in(name)
    closure = np.linspace(-0.2, 1.1, 14)
    weights = np.zeros((14, len(character.examples)))
    if key is not None:
        weights[:, character.examples.index(key)] = 1.0
    take = shown(character, weights, scalars={"lid_left": closure, "lid_right": np.zeros(14)})
    mapper = JointMapper(character, take)
    acting = mapper(take).weights
    neutral = openings(mapper, np.zeros((1, acting.shape[1])))
    blink = [mapper.pieces.names.index(piece) for piece in ("blink_L", "blink_R")]
    others = acting.copy()
    others[:, blink] = 0.0
    wanted = np.stack([1.0 - closure.clip(max=1.0), np.ones(14)], axis=-1) * neutral
    expected = np.minimum(wanted, openings(mapper, others))
    assert np.abs(openings(mapper, acting) - expected).max() < 1e-6
    assert openings(mapper, acting)[-1, 0] == pytest.approx(0.0, abs=1e-6)
    # The eye that does not blink is not touched by the other.
    assert np.ptp(acting[:, blink[1]]) < 0.05


def test_without_closures_the_lid_points_drive_the_blink(man: Character) -> None:
    wink = np.eye(len(man.examples))[[man.examples.index("blink_left")]]
    take = shown(man, wink, unseen=FACE_ON)
    mapper = JointMapper(man, take)
    weights = dict(zip(mapper.pieces.names, mapper(take).weights[0], strict=True))
    assert weights["blink_L"] > 0.85
    assert weights["blink_R"] < 0.05


@pytest.mark.parametrize("name", CHARACTERS)
def test_the_generic_face_serves_as_source_too(name: str) -> None:
    """Source examples (b): the same names on the generic face drive the same key models."""
    character, generic = built_in(name), built_in("generic")
    keys = [generic.keys.names.index(key) for key in character.examples]
    performer = replace(generic, examples=tuple(generic.keys.names[key] for key in keys))
    take = shown(performer, np.eye(len(keys)))
    mapper = JointMapper(character, take, Settings(examples="generic"))
    weights = mapper.key_weights(take)
    assert (weights.argmax(axis=1) == np.arange(len(keys))).all()
    assert np.diag(weights).min() > 0.6


def test_strangers_are_refused_in_words(man: Character, toy_face: Character) -> None:
    take = mixed(man)
    keys = replace(toy_face.keys, names=("odd", *toy_face.keys.names[1:]))
    odd = replace(toy_face, keys=keys, examples=keys.names)
    with pytest.raises(InputError, match="no key model 'odd'"):
        JointMapper(odd, take, Settings(examples="generic"))
    with pytest.raises(InputError, match="own"):
        JointMapper(man, take, Settings(examples="own"))
    few = acted(["8.3", "8.4"], np.zeros((2, 3)), np.zeros((1, 2, 3)), sigma=np.ones(2))
    with pytest.raises(InputError, match="only 2"):
        JointMapper(man, few)


def test_a_lopsided_face_with_other_key_models_is_driven(toy_face: Character) -> None:
    take = shown(toy_face, np.eye(len(toy_face.examples)))
    weights = JointMapper(toy_face, take).key_weights(take)
    assert np.diag(weights).min() > 0.7
