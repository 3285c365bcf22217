"""Blending faces: the genetic algorithm, the bounded optimum, and what is carried along."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import lsq_linear

from clips import write_video
from mien.capture.landmarks import Calibration
from mien.capture.lids import LidRange
from mien.capture.track import KEPT
from mien.capture.tracker.meet import ROWS, VERTICES, generic_person
from mien.errors import InputError
from mien.face.character import Character
from mien.face.databank import Databank, databank, performer_face, shape_space
from mien.face.library import generic_face
from mien.face.pieces import split
from mien.mapping import MAPPERS, Settings
from mien.mapping.blend import WEIGHT, Blend, blend, learn_misfit
from mien.mapping.bounded import bounded
from mien.mapping.genetic import Tournaments, draw, evolve, genetic, published
from mien.mapping.reconstruct import databank_scale, reconstruct
from mien.mapping.residual import believe, spread
from mien.mapping.surface import act_surface, told_points
from mien.numeric.qp import solve_boxes, solve_chain
from mien.numeric.rotation import from_vector
from mien.numeric.steady import steady
from mien.performance.acted import acted
from mien.performance.performance import Performance
from mien.recipe import capture

Array = np.ndarray
SHAPES = (
    "jawOpen", "mouthSmileLeft", "mouthSmileRight", "browInnerUp", "mouthPucker", "mouthFrownLeft",
    "browDownLeft", "browDownRight", "noseSneerLeft", "cheekPuff",
)  # fmt: skip


@pytest.fixture(scope="module")
def bank() -> Databank:
    """Ten shapes of the generic face."""
    return databank(replace(generic_face(), examples=SHAPES))


def problem(seed: int = 0, frames: int = 20, faces: int = 8, rate: float = 0.0) -> Blend:
    random = np.random.default_rng(seed)
    fields = random.normal(size=(faces, 12, 3)) * random.uniform(0.5, 5.0, (faces, 1, 1))
    weights = random.uniform(0.0, 1.0, (frames, faces)) ** 2
    motion = np.tensordot(weights, fields, axes=1) + 0.3 * random.normal(size=(frames, 12, 3))
    return blend(fields, motion, np.full(12, 0.1), rate)


def plainly(gram: Array, onto: Array, square: Array, start: Array, chance: Tournaments) -> Array:
    """The genetic algorithm, member by member, in numpy."""
    found = np.empty_like(onto)

    def cost(w: Array, f: int) -> float:
        return float(w @ gram @ w - 2.0 * w @ onto[f] + square[f])

    for f in range(len(onto)):
        pool = [member.copy() for member in start]
        costs = [cost(member, f) for member in pool]
        best, least = pool[int(np.argmin(costs))].copy(), min(costs)
        for t, (i, j, worst) in enumerate(chance.rivals):
            if costs[i] > costs[worst]:
                i, worst = worst, i
            if costs[j] > costs[worst]:
                j, worst = worst, j
            child = chance.shares[t] * pool[i] + (1.0 - chance.shares[t]) * pool[j]
            if chance.steps[t]:
                gene = chance.genes[t]
                step = chance.steps[t] * np.sqrt(max(least, 0.0) / gram[gene, gene])
                child[gene] = np.clip(child[gene] + step, 0.0, 1.0)
            pool[worst], costs[worst] = child, cost(child, f)
            if costs[worst] < least:
                best, least = child.copy(), costs[worst]
        found[f] = best
    return found


@pytest.mark.parametrize("step", [0.0, 0.3])
def test_the_kernel_is_the_plain_algorithm(step: float) -> None:
    task = problem()
    chance = draw(np.random.default_rng(5), 60, 8, 8, step)
    start = np.eye(8)
    arguments = (task.with_prior(), task.onto, task.square, start, chance)
    assert np.abs(evolve(*arguments) - plainly(*arguments)).max() < 1e-9


@settings(max_examples=25, deadline=None)
@given(seed=st.integers(0, 1000), generations=st.integers(0, 200))
def test_never_worse_than_the_best_member(seed: int, generations: int) -> None:
    task = problem(seed)
    bare = replace(task, gram=task.gram - WEIGHT**-2 * np.eye(8))
    members = np.diag(task.gram)[None] - 2.0 * task.onto + task.square[:, None]
    assert (bare.cost(published(task, seed, generations)) <= members.min(axis=1) + 1e-6).all()


def test_as_published_the_result_is_a_mean_of_faces() -> None:
    weights = published(problem(), seed=3)
    assert np.allclose(weights.sum(axis=1), 1.0)
    assert (weights >= 0.0).all()


def test_the_same_seed_gives_the_same_faces() -> None:
    task = problem()
    assert (published(task, 4) == published(task, 4)).all()
    assert (published(task, 4) != published(task, 5)).any()
    alone = replace(task, onto=task.onto[7:8], square=task.square[7:8])
    assert np.abs(published(alone, 4) - published(task, 4)[7]).max() < 1e-12


def test_repaired_comes_near_the_optimum_and_rests() -> None:
    task = problem(frames=40)
    exact = task.cost(bounded(task)).sum()
    assert exact <= task.cost(genetic(task)).sum() < 1.05 * exact
    still = replace(task, onto=0.0 * task.onto, square=0.0 * task.square)
    assert (genetic(still) == 0.0).all()


def test_bounded_is_scipys_optimum() -> None:
    random = np.random.default_rng(1)
    fields, motion = random.normal(size=(6, 12, 3)), 2.0 * random.normal(size=(9, 12, 3))
    found = bounded(blend(fields, motion, np.full(12, 0.25), 0.0))
    matrix = np.concatenate([2.0 * fields.reshape(6, -1).T, np.eye(6) / WEIGHT])
    for weights, wanted in zip(found, motion, strict=True):
        right = np.concatenate([2.0 * wanted.ravel(), np.zeros(6)])
        assert np.abs(weights - lsq_linear(matrix, right, (0.0, 1.0)).x).max() < 1e-6


def test_a_chain_meets_the_conditions_of_its_optimum() -> None:
    random = np.random.default_rng(2)
    root = random.normal(size=(5, 5))
    hessian, linear = root @ root.T + np.eye(5), 3.0 * random.normal(size=(30, 5))
    bounds = np.zeros(5), np.ones(5)
    x = solve_chain(hessian, linear, 4.0, bounds, 1e-9)
    pull = np.zeros_like(x)
    pull[1:] += x[1:] - x[:-1]
    pull[:-1] += x[:-1] - x[1:]
    slope = x @ hessian + linear + 4.0 * pull
    assert np.abs(np.clip(x - slope, 0.0, 1.0) - x).max() < 1e-6
    free = solve_boxes(hessian[None], linear, *bounds)
    assert np.abs(np.diff(x, axis=0)).sum() < np.abs(np.diff(free, axis=0)).sum()


def test_the_misfit_is_what_no_mix_shows() -> None:
    random = np.random.default_rng(3)
    fields = random.normal(size=(5, 30, 3))
    weights = random.uniform(0.0, 0.5, (200, 5))
    motion = np.tensordot(weights, fields, axes=1) + 0.5 * random.normal(size=(200, 30, 3))
    assert learn_misfit(fields, motion, np.full(30, 0.3), bounded) == pytest.approx(0.16, rel=0.25)
    assert learn_misfit(fields, motion, np.full(30, 0.5), bounded) < 0.03


def test_exact_markers_are_met_and_noise_is_not() -> None:
    random = np.random.default_rng(4)
    places = random.uniform(-60.0, 60.0, (20, 3))
    moved = random.normal(size=(50, 20, 3))
    met = spread(places, places) @ believe(moved, places, np.zeros(20))
    assert np.abs(met - moved).max() < 1e-3
    drowned = spread(places, places) @ believe(moved, places, np.full(20, 1.5))
    assert np.abs(drowned).max() < 1e-3
    assert not spread(places + 1000.0, places).any()


def perform(bank: Databank, noise: float = 0.0, frames: int = 90) -> tuple[Performance, Array]:
    """The databank's own person acts it; the true surface of every frame."""
    random = np.random.default_rng(6)
    wave = np.sin(np.linspace(0.0, 9.0, frames))[:, None] * random.uniform(0.2, 0.9, len(SHAPES))
    weights = np.clip(wave, 0.0, None)
    points = tuple(p for p in bank.face.points.ids if p.partition(".")[0] in "24589")
    rows = bank.face.points.index(points)
    fields = bank.face.points.at(bank.displacements)[:, rows]
    motion = np.tensordot(weights, fields, axes=1)
    motion += noise * random.standard_normal(motion.shape)
    neutral = bank.face.points.at(bank.face.vertices)[rows]
    performance = acted(points, neutral, motion, sigma=np.full(len(points), 0.3), rate=120.0)
    return performance, np.tensordot(weights, bank.displacements, axes=1)


def test_a_surface_is_reconstructed_from_its_points(bank: Databank) -> None:
    performance, true = perform(bank, noise=0.5)
    skin = np.linalg.norm(true, axis=-1).max(axis=0) > 0.5

    def error(**how: object) -> float:
        surface = reconstruct(performance, bank, **how)
        shown = np.stack([surface.motion(f) for f in range(len(performance))])
        return float(np.linalg.norm(shown - true, axis=-1)[:, skin].mean())

    nothing = float(np.linalg.norm(true, axis=-1)[:, skin].mean())
    assert error() < 0.1 * nothing
    assert error() < error(solver="published") < nothing
    assert error() < error(smooth=False)


def test_the_axes_of_the_performer_do_not_count(bank: Databank) -> None:
    performance, _ = perform(bank)
    turn = from_vector(np.array([0.3, 0.5, -0.2]))
    turned = replace(
        performance, neutral=performance.neutral @ turn.T + 7.0, motion=performance.motion @ turn.T
    )
    first, second = (reconstruct(each, bank) for each in (performance, turned))
    assert np.abs(first.motion(40) - second.motion(40)).max() < 1e-6


def test_motion_comes_back_at_the_performers_size(bank: Databank) -> None:
    performance, _ = perform(bank)
    larger = replace(
        performance, neutral=1.2 * performance.neutral, motion=1.2 * performance.motion
    )
    first, second = (reconstruct(each, bank) for each in (performance, larger))
    assert second.scale == pytest.approx(1.0 / 1.2)
    assert np.abs(1.2 * first.motion(40) - second.motion(40)).max() < 0.1


def test_the_scale_is_the_mean_of_four_ratios(bank: Databank) -> None:
    points = ["8.3", "8.4", "4.5", "4.6", "9.3", "2.1", "5.3", "5.4"]
    worn = bank.face.points.at(bank.face.vertices)[bank.face.points.index(points)].copy()
    assert databank_scale(points, worn, bank.face) == pytest.approx(1.0)
    wide = worn.copy()
    wide[:2] = worn[:2].mean(axis=0) + 2.0 * (worn[:2] - worn[:2].mean(axis=0))
    assert databank_scale(points, wide, bank.face) == pytest.approx(3.5 / 4.0)
    with pytest.raises(InputError, match="no scale"):
        databank_scale(["9.1"], worn[:1], bank.face)


def test_what_was_reconstructed_is_what_plays(bank: Databank) -> None:
    performance, _ = perform(bank, noise=0.3)
    surface = reconstruct(performance, bank)
    character, curves = act_surface(surface, performance, "her")
    assert curves.names == character.keys.names
    for frame in range(0, 90, 9):
        shown = np.tensordot(curves.weights[frame], character.keys.displacements, axes=1)
        assert np.linalg.norm(shown - surface.motion(frame), axis=-1).mean() < 0.03


def test_points_without_markers_are_told(bank: Databank) -> None:
    performance, true = perform(bank)
    told = told_points(reconstruct(performance, bank), performance)
    assert set(told.points) == set(bank.face.points.ids)
    inner = bank.face.points.index(["2.3"])
    wanted = bank.face.points.at(true)[:, inner]
    found = told.motion[:, [told.points.index("2.3")]]
    assert np.linalg.norm(found - wanted, axis=-1).mean() < 0.1 * np.abs(wanted).max()


def test_what_cannot_be_is_told(bank: Databank, toy_face: Character) -> None:
    performance, _ = perform(bank)
    with pytest.raises(InputError, match="bounded, genetic, published"):
        reconstruct(performance, bank, solver="cardinal")
    with pytest.raises(InputError, match="build both from the same"):
        reconstruct(performance, bank, face=toy_face.face)
    flat = replace(performance, unseen=np.tile([0.0, 0.0, 1.0], (90, 1)))
    with pytest.raises(InputError, match="no depth"):
        reconstruct(flat, bank)
    few = replace(performance, points=("8.3",), neutral=performance.neutral[:1])
    with pytest.raises(InputError, match="at least 8"):
        reconstruct(few, bank)


def test_a_performer_wears_the_databanks_mesh(bank: Databank) -> None:
    own = 1.1 * bank.face.vertices
    face = performer_face(bank, own)
    assert (face.vertices == own).all()
    assert face.pivots["jaw"] == pytest.approx(1.1 * bank.face.pivots["jaw"])
    away = own @ np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]]) + 300.0
    assert np.abs(performer_face(bank, away).vertices - own).max() < 10.0
    with pytest.raises(ValueError, match="vertices"):
        performer_face(bank, own[:-1])
    with pytest.raises(ValueError, match="millimetres"):
        performer_face(bank, own / 1000.0)


def test_steadying_keeps_peaks_and_knows_what_noise_it_leaves() -> None:
    time = np.arange(2000) / 120.0
    noise = 0.3 * np.random.default_rng(0).standard_normal((2000, 3))
    slow = np.repeat(10.0 * np.sin(3.0 * time)[:, None], 3, axis=1)
    smoothed, left = steady(slow + noise, 120.0)
    assert left < 0.5
    assert (smoothed - slow)[50:-50].std() == pytest.approx(0.3 * left, rel=0.5)
    assert np.ptp(smoothed[:, 0]) == pytest.approx(20.0, rel=0.03)
    exact, _ = steady(slow, 120.0)
    assert np.abs(exact - slow).max() < 0.02


def test_characters_are_driven_by_their_key_models_as_a_population(bank: Databank) -> None:
    performance, _ = perform(bank, frames=30)
    character = bank.character()
    mapper = MAPPERS["genetic"](character, performance, Settings())
    curves = mapper(performance)
    assert curves.names == split(character).names
    assert (
        np.abs(mapper(_frames(performance, slice(11, 14))).weights - curves.weights[11:14]).max()
        < 1e-9
    )
    blind = replace(performance, unseen=np.tile([0.0, 0.0, 1.0], (30, 1)))
    turning = blind.unseen.copy()
    turning[0] = [1.0, 0.0, 0.0]
    first, second = (mapper(each).weights for each in (blind, replace(blind, unseen=turning)))
    assert np.abs(first[1:] - second[1:]).max() < 1e-9
    rest = replace(performance, motion=0.0 * performance.motion)
    assert np.abs(mapper(rest).weights).max() < 1e-6


def _frames(performance: Performance, run: slice) -> Performance:
    names = ("time", "motion", "rotation", "translation", "gaze", "confidence", "lost", "unseen")
    return replace(performance, **{name: getattr(performance, name)[run] for name in names})


def test_a_databank_is_a_space_for_the_tracker(bank: Databank, toy_face: Character) -> None:
    space = shape_space(bank)
    assert space.names == SHAPES
    scale = space.neutral[0, 1] / bank.face.vertices[0, 1]
    assert np.allclose(space.neutral, scale * bank.face.vertices[: len(space.neutral)])
    assert np.allclose(space.expression[0], scale * bank.displacements[0, :468], atol=1e-6)
    with pytest.raises(ValueError, match="not built on the generic face"):
        shape_space(databank(toy_face))


def test_the_tracker_meets_whom_a_databank_knows(bank: Databank) -> None:
    space = shape_space(bank)
    model = np.zeros((len(KEPT), 3))
    model[ROWS] = space.neutral[VERTICES]
    eyes = LidRange(np.full(2, 0.3), np.full(2, 0.05))
    known = Calibration(
        model, np.zeros_like(model), eyes, np.zeros((2, 2)), np.array([0.0, 0.0, 500.0]), 600.0
    )
    met = generic_person(known, (640, 480), space)
    assert met.space.names == SHAPES
    np.testing.assert_allclose(met.neutral[VERTICES], space.neutral[VERTICES], atol=0.01)


def test_scanned_faces_are_for_the_tracker_alone(tmp_path: Path) -> None:
    write_video(tmp_path / "take.mp4", [np.zeros((64, 64, 3), np.uint8)] * 3)
    with pytest.raises(InputError, match="--capture tracker"):
        capture(tmp_path / "take.mp4", method="landmarks", faces="woman")
