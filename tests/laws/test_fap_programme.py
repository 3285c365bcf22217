"""FAPs from motion: what was posed comes back, certified, and drives any character."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from actors import FACE_ON, built_in
from mien.capture.fap import motion_from_faps
from mien.capture.landmarks import POINTS, SIGMA, SPANS
from mien.capture.shapes import motion_from_shapes
from mien.errors import InputError
from mien.face.character import Character
from mien.face.fap_targets import basis_of, fap_models, fap_weights
from mien.face.library import generic_face
from mien.mapping import MAPPERS, Settings
from mien.mapping.arkit import arkit_weights
from mien.mapping.fap import FapMapper, FapProgramme, fap_values, parted
from mien.numeric.qp import kkt_residual, solve_boxes
from mien.performance.acted import acted
from mien.performance.performance import Performance
from mien.vocabulary.fap import column, expressions, simple, visemes

SURE = 0.02
"""mm of noise that a programme is told of where there is none."""


def showing(
    character: Character,
    values: np.ndarray,
    *,
    points: tuple[str, ...] | None = None,
    sigma: float = SURE,
    unseen: np.ndarray | None = None,
) -> Performance:
    """``character`` posed by FAP ``values`` (F, 66), as one sees its points."""
    face = character.face
    ids = tuple(p for p in points or face.points.ids if p in face.points.ids)
    rows = face.points.index(ids)
    motion = np.tensordot(values, face.points.at(basis_of(character).fields)[:, rows], axes=1)
    neutral = face.points.at(face.vertices)[rows]
    return acted(ids, neutral, motion, sigma=np.full(len(ids), sigma), unseen=unseen)


def moving(frames: int, seed: int, part: float = 0.7) -> np.ndarray:
    """(F, 66) values within ``part`` of what faces can do; nothing turns."""
    lower, upper = np.array([(fap.lower, fap.upper) for fap in simple()]).T
    values = np.random.default_rng(seed).uniform(part * lower, part * upper, (frames, 66))
    values[:, [fap.axis is None for fap in simple()]] = 0.0
    return values


def spoken(values: np.ndarray, vocabulary: str = "fap") -> Performance:
    """A performance that came as values."""
    still = acted((), np.zeros((0, 3)), np.zeros((len(values), 0, 3)), sigma=np.zeros(0))
    return replace(still, vocabulary=vocabulary, shapes=values)


@pytest.mark.parametrize("name", ["man", "woman", "monkey", "toy"])
@pytest.mark.parametrize("camera", [False, True])
def test_faps_of_a_face_posed_by_faps_come_back(name: str, camera: bool) -> None:
    character = built_in(name)
    values = moving(20, seed=3)
    take = showing(
        character, values, points=POINTS if camera else None, unseen=FACE_ON if camera else None
    )
    programme = FapProgramme(take, basis_of(character), character.face)
    found = programme(take)
    seen = [
        column(fap.number)
        for fap in simple()
        if fap.axis is not None
        and not (camera and fap.axis == 2)
        and fap.point in take.points
        and fap.point not in ("3.5", "3.6")
    ]
    assert len(seen) > 40
    assert np.abs(found.values - values)[:, seen].max() < 1.0
    assert found.kkt.max() < 1e-8


def test_bounds_hold_and_the_certificate_says_it_is_the_minimum() -> None:
    generic = generic_face()
    take = showing(generic, 2.5 * moving(12, seed=4), points=POINTS, sigma=1.0, unseen=FACE_ON)
    programme = FapProgramme(take, basis_of(generic), generic.face)
    found = programme(take)
    lower, upper = np.array([(fap.lower, fap.upper) for fap in simple()]).T
    held = np.isclose(found.values, lower) | np.isclose(found.values, upper)
    assert (found.values >= lower - 1e-9).all()
    assert (found.values <= upper + 1e-9).all()
    assert held[:, [column(n) for n in (4, 5, 31, 53)]].any()
    assert found.kkt.max() < 1e-8
    hessians, linear = programme.problem(take, slice(0, 12))
    best = solve_boxes(hessians, linear, *programme.bounds)
    worse = best + 1e-4 * np.sign(np.random.default_rng(0).normal(size=best.shape))
    assert (kkt_residual(hessians, linear, worse, *programme.bounds) > 1e-6).all()


def test_a_frame_alone_is_as_in_the_take() -> None:
    generic = generic_face()
    take = showing(generic, moving(9, seed=5), points=POINTS, sigma=1.0, unseen=FACE_ON)
    programme = FapProgramme(take, basis_of(generic), generic.face)
    alone = {
        name: getattr(take, name)[4:5]
        for name in (
            *("time", "motion", "rotation", "translation", "gaze"),
            *("confidence", "lost", "unseen"),
        )
    }
    whole = programme(take).values[4]
    np.testing.assert_allclose(programme(replace(take, **alone)).values[0], whole, atol=1e-5)


def test_a_smaller_performer_gives_the_same_faps() -> None:
    generic = generic_face()
    values = moving(6, seed=6, part=0.4)
    take = showing(generic, values)
    small = replace(take, neutral=0.8 * take.neutral, motion=0.8 * take.motion)
    np.testing.assert_allclose(fap_values(small), fap_values(take), atol=1.0)


def test_noise_on_a_still_face_moves_little() -> None:
    """Rest and kinship: one camera, the landmark capture's points and certainties."""
    generic = generic_face()
    face = generic.face
    rows = face.points.index(POINTS)
    neutral = face.points.at(face.vertices)[rows]
    noise = np.random.default_rng(7).normal(0.0, 1.0, (40, len(POINTS), 3))
    take = acted(POINTS, neutral, noise, sigma=SIGMA, unseen=FACE_ON, spans=SPANS)
    values = fap_values(take)
    motion = np.tensordot(values, face.points.at(basis_of(generic).fields)[:, rows], axes=1)
    assert np.sqrt((motion**2).sum(axis=-1).mean()) < 1.0
    depth = values[:, [column(14), column(16), column(17)]]
    assert np.abs(depth).max() < 25.0  # nothing was seen of it


def test_faps_that_came_as_such_pass_as_they_are() -> None:
    toy = built_in("toy")
    values = np.stack([visemes()["a"], expressions()["joy"]])
    take = motion_from_faps(spoken(values), generic_face())
    curves = MAPPERS["fap"](toy, take, Settings())(take)
    assert curves.names == fap_models(toy).names
    np.testing.assert_array_equal(curves.weights, fap_weights(toy, values))
    np.testing.assert_array_equal(fap_values(take), values)


def test_smoothing_does_not_push_lips_through_each_other() -> None:
    """Each weight is smoothed by itself: lips that shut fast would overtake each other."""
    man = built_in("man")
    together = np.stack([visemes()["a"], expressions()["joy"], np.zeros(66)])
    names = ("lower_t_midlip", "raise_b_midlip")
    take = motion_from_faps(spoken(together), generic_face())
    curves = MAPPERS["fap"](man, take, Settings())(take)
    np.testing.assert_allclose(parted(curves, man).weights, curves.weights, atol=1e-12)
    columns = [curves.names.index(name) for name in names]
    weights = curves.weights.copy()
    weights[:, columns] = 0.3
    weights[:, curves.names.index("slide_t_l_eyelid")] = 0.0
    mended = parted(replace(curves, weights=weights), man).weights
    reach = [fap.reach for fap in simple() if fap.name in names]
    np.testing.assert_allclose(mended[:, columns] @ reach, basis_of(man).closed, atol=1e-9)
    np.testing.assert_allclose(
        mended[:, curves.names.index("slide_t_l_eyelid")],
        curves.weights[:, curves.names.index("slide_t_l_eyelid")],
    )


def test_curves_of_other_mappings_are_left_alone() -> None:
    man = built_in("man")
    take = showing(man, np.zeros((2, 66)), points=POINTS)
    curves = MAPPERS["cardinal"](man, take, Settings())(take)
    assert parted(curves, man) is curves


def test_closures_that_were_measured_shut_the_eyes() -> None:
    man = built_in("man")
    take = showing(man, np.zeros((3, 66)), points=POINTS)
    closed = np.array([0.0, 0.5, 1.0])
    take = replace(take, scalars={"lid_left": closed, "lid_right": 0.0 * closed})
    curves = FapMapper(man, take)(take)
    weights = dict(zip(curves.names, curves.weights.T, strict=True))
    np.testing.assert_allclose(weights["close_t_l_eyelid"] * 1100, 1024 * closed, atol=2.0)
    np.testing.assert_allclose(weights["close_t_r_eyelid"], 0.0, atol=0.01)
    np.testing.assert_allclose(weights["slide_t_l_eyelid"], [0.0, 1.0, 0.0], atol=0.01)


def test_gain_stretches_values_and_bounds() -> None:
    man = built_in("man")
    values = 0.5 * moving(4, seed=8)
    take = showing(man, values)
    once = FapProgramme(take, basis_of(man), man.face)(take).values
    twice = FapProgramme(take, basis_of(man), man.face, Settings(gain=2.0))(take).values
    translated = [fap.axis is not None for fap in simple()]
    np.testing.assert_allclose(twice[:, translated], 2.0 * once[:, translated], atol=1.0)


def test_too_few_points_are_told() -> None:
    take = showing(generic_face(), np.zeros((2, 66)), points=("2.1", "2.2", "2.3"))
    with pytest.raises(InputError, match="feature points of MPEG-4"):
        fap_values(take)


def test_the_way_through_arkit_keeps_most() -> None:
    generic = generic_face()
    values = np.stack([*visemes().values(), *expressions().values()])
    weights = arkit_weights(motion_from_faps(spoken(values), generic), generic)
    back = fap_values(motion_from_shapes(spoken(weights, "arkit"), generic))
    for group, most in ((2, 0.45), (4, 0.7), (8, 0.45)):
        columns = [column(fap.number) for fap in simple() if fap.group == group]
        lost = np.abs(back - values)[:, columns].mean() / np.abs(values)[:, columns].mean()
        assert lost < most, group
