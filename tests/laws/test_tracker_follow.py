"""The tracker on a painted face whose motion is known: no detector, no film."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np
import pytest

from mien.capture.track import KEPT, LandmarkTrack
from mien.capture.tracker.capture import follow_take
from mien.capture.tracker.chart import read, unroll
from mien.capture.tracker.crop import Crop, cut, pack, unpack
from mien.capture.tracker.look import take, visible
from mien.capture.tracker.meet import ROWS, VERTICES, spread_views
from mien.capture.tracker.perform import confidences
from mien.capture.tracker.person import person
from mien.capture.tracker.prior_term import MotionTerm
from mien.capture.tracker.silhouette_term import folds, match
from mien.capture.tracker.solve import solve
from mien.capture.tracker.state import State
from mien.capture.tracker.texture_term import Normaliser, TextureTerm
from mien.capture.tracker.trace import trace
from mien.capture.tracker.track import Tracker
from mien.capture.tracker.trust import Trust
from mien.capture.tracker.visibility import contour, facing
from mien.face.shape_space import generic_space, principal_modes
from mien.numeric.raster import NOTHING, rasterize
from mien.numeric.rotation import angle_between, from_vector

FOCAL, SIZE = 500.0, (240, 240)
FRONTAL = np.diag([1.0, -1.0, -1.0])
SPACE = generic_space()


@pytest.fixture(scope="module")
def somebody():
    corners = np.repeat(VERTICES[:, None], 3, axis=1).astype(np.int32)
    shares = np.tile([1.0, 0.0, 0.0], (len(VERTICES), 1))
    return person(SPACE, SPACE.neutral, (corners, shares), ROWS, FOCAL, SIZE)


def posed(yaw: float = 0.0, pitch: float = 0.0, **weights: float) -> State:
    level = np.zeros(len(SPACE.names))
    for name, value in weights.items():
        level[SPACE.names.index(name)] = value
    turn = FRONTAL @ from_vector(np.radians([pitch, yaw, 0.0]))
    return State(turn, np.array([4.0, 20.0, 430.0]), level)


def paint(state: State) -> np.ndarray:
    """(H, W, 3) the generic mask with freckles, drawn as the state has it."""
    shape = SPACE.neutral + np.tensordot(state.weights, SPACE.expression, axes=1)
    seen = shape @ state.rotation.T + state.translation
    pixels = FOCAL * seen[:, :2] / seen[:, 2:] + np.array(SIZE) / 2.0
    fine = 2
    screen = np.column_stack([pixels * fine, 1000.0 / seen[:, 2]]).astype(np.float32)
    flags = np.zeros(len(SPACE.triangles), dtype=bool)
    ids, _ = rasterize(screen, SPACE.triangles, flags, SIZE[0] * fine, SIZE[1] * fine)
    rows, columns = np.nonzero(ids != NOTHING)
    corner = SPACE.triangles[ids[rows, columns]]
    a, b, c = np.moveaxis(pixels[corner] * fine, 1, 0)
    at = np.stack([columns, rows], axis=1) + 0.5
    matrix = np.stack([b - a, c - a], axis=2)
    shares = np.linalg.solve(matrix, (at - a)[..., None])[..., 0]
    shares = np.column_stack([1.0 - shares.sum(1), shares])
    # Paint goes with the skin: it is a function of the place at rest.
    x, y, z = np.einsum("ncx,nc->xn", SPACE.neutral[corner], shares)
    grey = 130 + 28 * np.sin(x / 3.1 + 0.4 * z) * np.cos(y / 4.3) + 22 * np.sin(y / 6.7 - x / 9.0)
    picture = np.full((SIZE[1] * fine, SIZE[0] * fine), 60.0)
    picture[rows, columns] = grey
    picture = picture.reshape(SIZE[1], fine, SIZE[0], fine).mean((1, 3))
    return np.repeat(picture[..., None], 3, axis=2).astype(np.uint8)


def landmarks(somebody, state: State, bias: float = 0.0) -> np.ndarray:
    """(N, 2) where an exact detector sees them, or one whose error grows with the turn."""
    points = somebody.lens().project(somebody.landmarks.seen(state))
    yaw = np.arctan2(state.rotation[0, 2], -state.rotation[2, 2])
    return points + bias * np.sin(yaw) * np.sin(np.arange(len(points)))[:, None]


def crop_of(state: State, points: np.ndarray) -> Crop:
    return cut(paint(state), points)


def degrees(found: State, truth: State) -> float:
    return float(np.degrees(angle_between(found.rotation, truth.rotation)))


def test_a_chart_lays_its_texels_on_the_skin():
    chart = unroll(SPACE)
    np.testing.assert_allclose(chart.shares.sum(1), 1.0, atol=1e-9)
    assert chart.shares.min() > -0.05
    places = chart.sites(SPACE.neutral, SPACE.expression).neutral
    right, down = chart.slopes(places, np.flatnonzero(chart.inner))
    assert np.median(np.linalg.norm(right, axis=1)) == pytest.approx(2.0, rel=0.3)
    assert np.median(np.linalg.norm(down, axis=1)) == pytest.approx(2.0, rel=0.3)


def test_what_turns_away_is_not_seen(somebody):
    front, side = posed(), posed(yaw=50.0)
    cosine = facing(somebody.chart, somebody.texels.seen(side))
    left = somebody.texels.neutral[:, 0] > 25.0
    right = somebody.texels.neutral[:, 0] < -25.0
    assert cosine[left].mean() < cosine[right].mean() - 0.5
    crop = Crop(np.zeros((240, 240), np.uint8), 1.0, (0.0, 0.0))
    assert visible(somebody, crop, front).mean() > 0.7
    assert visible(somebody, crop, side).mean() < visible(somebody, crop, front).mean() - 0.15


def test_slopes_are_differences_of_neighbours(somebody):
    chart = somebody.chart
    values = np.random.default_rng(8).normal(size=(len(chart), 2))
    rows = np.flatnonzero(chart.inner)[::17]
    left, right, above, below = chart.near[rows].T
    across, down = chart.slopes(values, rows)
    np.testing.assert_allclose(across, (values[right] - values[left]) / 2.0)
    np.testing.assert_allclose(down, (values[below] - values[above]) / 2.0)
    assert chart.slopes(values[:, 0], rows)[0].shape == (len(rows),)


def test_reading_between_pixels_is_linear():
    y, x = np.mgrid[:9, :9].astype(np.float32)
    at = np.array([[3.2, 4.7], [0.5, 0.5], [7.9, 2.25]])
    np.testing.assert_allclose(
        read(2 * x + 3 * y, at), 2 * at[:, 0] + 3 * at[:, 1] - 2.5, rtol=1e-5
    )


def test_a_looks_slope_is_that_of_its_differences(somebody):
    state = posed(yaw=5.0)
    crop = crop_of(state, landmarks(somebody, state))
    look = take(somebody, crop, state)
    rows = np.flatnonzero(somebody.chart.inner & look.seen)[::3]
    normalise = Normaliser(somebody.chart, look.seen)
    picture = cv2.GaussianBlur(crop.image.astype(np.float32), (0, 0), 2.5)
    level = read(picture, somebody.lens(crop).project(somebody.texels.seen(state)))
    wanted = normalise(level)
    term = TextureTerm(
        somebody.chart,
        somebody.texels,
        somebody.texels.take(rows),
        rows,
        picture,
        somebody.lens(crop),
        normalise,
        wanted,
        1.0,
    )
    linear = term.linearize(state)
    assert np.abs(linear.residual).max() == pytest.approx(0.0, abs=1e-6)
    scale = 1e-3  # the residual's own deviation, which has a least value
    counted = normalise.inner[rows]
    for column, step in ((0, 2e-3), (1, 2e-3), (3, 0.2), (4, 0.2)):
        change = np.zeros(6 + len(SPACE.names))
        change[column] = step
        ends = [normalise(term.look(state.moved(s * change)))[rows] for s in (1, -1)]
        slope = ((ends[0] - ends[1]) / (2 * step))[counted]
        guess = linear.jacobian[counted, column] * scale
        assert np.corrcoef(slope, guess)[0, 1] > 0.85
        assert 0.7 < float(slope @ guess / (guess @ guess)) < 1.4


def test_the_skin_is_followed_where_landmarks_lie(somebody):
    start = posed()
    look = take(somebody, crop_of(start, landmarks(somebody, start)), start)
    errors: dict[bool, list[float]] = {True: [], False: []}
    for textured in errors:
        tracker = Tracker(somebody, [look], start, Trust(texture=0.15 if textured else 0.0))
        for yaw in np.linspace(0.0, 20.0, 9):
            truth = posed(yaw=float(yaw), smile=0.02 * float(yaw))
            points = landmarks(somebody, truth, bias=12.0)
            found = tracker.step(crop_of(truth, points), points)
            errors[textured].append(degrees(found.state, truth))
    assert max(errors[True]) < 1.0
    assert np.mean(errors[True]) < 0.5 * np.mean(errors[False])


@pytest.mark.parametrize("share", [0.75, 1.4])
def test_a_camera_of_unknown_focal_length_costs_a_tenth_of_the_turn(somebody, share):
    believed, start = replace(somebody, focal=FOCAL * share), posed()
    crop = crop_of(start, landmarks(somebody, start))
    nearer = replace(start, translation=start.translation * np.array([1.0, 1.0, share]))
    tracker = Tracker(believed, [take(believed, crop, nearer)], nearer)
    for yaw in np.linspace(2.0, 20.0, 7):
        truth = posed(yaw=float(yaw), pitch=0.4 * float(yaw))
        points = landmarks(somebody, truth)
        found = tracker.step(crop_of(truth, points), points)
        assert degrees(found.state, truth) < 0.1 * degrees(start, truth) + 0.1


def test_points_stay_on_their_skin(somebody):
    start = posed()
    look = take(somebody, crop_of(start, landmarks(somebody, start)), start)
    tracker = Tracker(somebody, [look], start, Trust(points=0.1))
    for frame in range(6):
        truth = posed(yaw=1.5 * frame)
        points = landmarks(somebody, truth)
        found = tracker.step(crop_of(truth, points), points)
    assert len(found.points) > 20
    tracks = tracker.tracks
    tracks.follow(crop_of(posed(yaw=9.0), points))
    held = tracks.held
    there = somebody.lens().project(tracks.sites.seen(posed(yaw=9.0)))
    away = np.linalg.norm(tracks.places - there, axis=1)[held]
    assert held.sum() > 20
    assert np.median(away) < 0.5


def test_a_point_that_is_covered_is_let_go(somebody):
    start = posed()
    points = landmarks(somebody, start)
    crop = crop_of(start, points)
    tracker = Tracker(somebody, [take(somebody, crop, start)], start, Trust(points=0.1))
    tracker.step(crop, points)
    tracker.step(crop, points)
    hidden = crop_of(start, points)
    noise = np.random.default_rng(1).integers(0, 255, hidden.image.shape).astype(np.uint8)
    hidden.image[:, : hidden.size[0] // 2] = noise[:, : hidden.size[0] // 2]
    tracker.tracks.follow(hidden)
    left = crop.scale * (tracker.tracks.places[:, 0] - crop.origin[0]) < 0.4 * crop.size[0]
    assert tracker.tracks.held[left].mean() < 0.2
    assert tracker.tracks.held[~left].mean() > 0.6


def test_the_outline_is_drawn_to_the_edge(somebody):
    truth = posed(yaw=42.0)
    crop = crop_of(truth, landmarks(somebody, truth))
    off = replace(truth, translation=truth.translation + np.array([2.5, 0.0, 0.0]))
    picture = crop.image.astype(np.float32)
    term = match(somebody, folds(SPACE.triangles), crop, picture, off, 1.0, 1.0)
    assert len(term.edges) > 5
    exact = term.pairs(truth)
    across = ((exact[:, 0] - exact[:, 1]) * term.normals).sum(axis=1)
    assert np.median(np.abs(across)) < 1.0
    stiff = MotionTerm(off, 1e-4, 3.0, 1e-4)
    found = solve(off, [term, stiff], 3)
    assert abs(found.translation[0] - truth.translation[0]) < 1.0


def test_noise_leaves_the_head_still(somebody):
    random = np.random.default_rng(5)
    start = posed()
    points = landmarks(somebody, start)
    picture = paint(start)
    tracker = Tracker(somebody, [take(somebody, cut(picture, points), start)], start)
    turns = []
    for _ in range(12):
        noisy = np.clip(picture + random.normal(0, 2, picture.shape), 0, 255).astype(np.uint8)
        trembling = points + random.normal(0.0, 0.15, points.shape)
        turns.append(tracker.step(cut(noisy, trembling), trembling).state.rotation)
    away = np.degrees(angle_between(np.array(turns), start.rotation))
    assert np.sqrt((away[4:] ** 2).mean()) < 0.1


def test_a_thing_before_the_face_costs_agreement_and_little_pose(somebody):
    start = posed()
    look = take(somebody, crop_of(start, landmarks(somebody, start)), start)
    tracker = Tracker(somebody, [look], start)
    free, covered = [], []
    for frame in range(12):
        truth = posed(yaw=0.6 * frame)
        points = landmarks(somebody, truth)
        crop = crop_of(truth, points)
        hidden = frame >= 6
        if hidden:
            height, width = crop.image.shape
            crop.image[height // 2 : height * 4 // 5, width // 5 : width * 3 // 5] = 90
        found = tracker.step(crop, points)
        (covered if hidden else free).append((found.cost, degrees(found.state, truth)))
    assert np.mean(covered, axis=0)[0] > 1.5 * np.mean(free, axis=0)[0]
    assert max(covered)[1] < 1.5


def test_a_face_that_returns_is_found_at_once(somebody):
    start = posed()
    look = take(somebody, crop_of(start, landmarks(somebody, start)), start)
    tracker = Tracker(somebody, [look], start)
    tracker.lose()
    truth = posed(yaw=25.0, pitch=-8.0)
    points = landmarks(somebody, truth)
    found = tracker.step(crop_of(truth, points), points)
    assert degrees(found.state, truth) < 1.0
    assert found.notes == ("recovered",)


def test_meeting_mends_the_pose_at_rest(somebody):
    """Landmarks that place the face at rest wrongly are corrected by other views."""
    frames = [posed()] * 6 + [posed(yaw=25.0 * np.sin(0.25 * i), pitch=5.0) for i in range(24)]
    exact = np.array([landmarks(somebody, state) for state in frames])
    tilted = np.array([landmarks(somebody, replace(s, rotation=s.rotation @ TILT)) for s in frames])
    points = np.zeros((len(frames), len(KEPT), 3), dtype=np.float32)
    points[:, ROWS, :2] = tilted
    crops = [crop_of(state, seen) for state, seen in zip(frames, exact, strict=True)]
    time = np.arange(len(frames)) / 30.0
    track = LandmarkTrack(time, points, np.zeros(len(frames), dtype=bool), SIZE)
    errors = []
    for meeting in (False, True):
        done = follow_take(track, crops, somebody, slice(0, 6), Trust(meeting=meeting))
        errors.append(
            np.mean([degrees(f.state, t) for f, t in zip(done.found, frames, strict=True)])
        )
    assert errors[1] < 0.6 * errors[0]


TILT = from_vector(np.radians([3.0, 2.0, 0.0]))


def test_views_lie_apart_not_too_far_and_act_little():
    yaw = np.radians(np.linspace(-60.0, 60.0, 121))
    turns = from_vector(np.stack([np.zeros(121), yaw, np.zeros(121)], axis=1))
    acting = np.where(np.arange(121) % 5 == 0, 0.5, 0.0)
    states = [State(t, np.zeros(3), np.full(2, a)) for t, a in zip(turns, acting, strict=True)]
    chosen = spread_views(states, np.eye(3))
    assert len(chosen) == 12
    assert np.abs(np.degrees(yaw[chosen])).max() <= 38.0
    assert np.diff(chosen).min() >= 3
    assert not acting[chosen].any()


def test_doubt_is_relative_to_the_take():
    costs = np.array([0.2] * 20 + [0.5] * 5)
    known = confidences(costs)
    assert known[:20].min() > 0.75
    assert known[20:].max() < 0.5 * known[:20].min()
    np.testing.assert_allclose(confidences(2 * costs), known)


def test_a_crop_is_kept_nearly_as_it_is(somebody):
    state = posed(yaw=10.0)
    crop = crop_of(state, landmarks(somebody, state))
    again = unpack(pack(crop))
    assert (again.scale, again.origin) == (crop.scale, crop.origin)
    assert np.abs(again.image.astype(int) - crop.image).mean() < 1.5


@pytest.mark.parametrize("corner", [(-300.0, -300.0), (500.0, 100.0)])
def test_a_face_outside_the_picture_gives_some_crop(corner):
    points = np.array(corner) + np.random.default_rng(0).uniform(0, 60, (30, 2))
    crop = cut(np.zeros((120, 160, 3), np.uint8), points)
    assert min(crop.image.shape) >= 16


def test_a_large_face_is_made_smaller():
    points = np.array([[100.0, 100.0], [900.0, 900.0]])
    crop = cut(np.zeros((1000, 1000, 3), np.uint8), points)
    assert 150 < 800 * crop.scale < 260


def test_the_outline_goes_round_the_face(somebody):
    state = posed(yaw=30.0)
    found = Tracker(somebody, [], state, Trust(texture=0.0)).step(
        crop_of(state, landmarks(somebody, state)), landmarks(somebody, state)
    )
    shown = trace(somebody, found)
    outline, wire = shown.curves["silhouette"], shown.wire.reshape(-1, 2)
    assert np.ptp(outline, axis=0) == pytest.approx(np.ptp(wire, axis=0), rel=0.1)
    seen = somebody.neutral @ state.rotation.T + state.translation
    assert len(contour(seen, SPACE.triangles)) > 20


def test_a_trace_shows_what_each_term_went_by(somebody):
    start = posed(yaw=30.0)
    points = landmarks(somebody, start)
    crop = crop_of(start, points)
    look = take(somebody, crop, start)
    tracker = Tracker(somebody, [look], start, Trust(points=0.1, silhouette=0.3))
    tracker.step(crop, points)
    shown = trace(somebody, tracker.step(crop, points))
    assert len(shown.points) > 500
    squares = np.array(list(shown.boxes.values())).mean(axis=1)
    assert len(squares) > 20
    edges = np.array([ends for name, ends in shown.curves.items() if name.startswith("edge")])
    assert len(edges) > 3
    outline = shown.curves["silhouette"]
    for place in edges[:, 0]:
        assert np.linalg.norm(outline - place, axis=1).min() < 12.0


def test_modes_give_back_what_they_were_made_of():
    random = np.random.default_rng(2)
    shapes = random.normal(size=(6, 30, 3))
    mean, modes = principal_modes(shapes, 5)
    flat = modes.reshape(len(modes), -1)
    for shape in shapes:
        part = np.linalg.lstsq(flat.T, (shape - mean).ravel(), rcond=None)[0]
        np.testing.assert_allclose(mean.ravel() + part @ flat, shape.ravel(), atol=1e-9)
    with pytest.raises(ValueError, match="two"):
        principal_modes(shapes[:1], 5)


def test_a_person_of_the_space_is_recognised():
    wanted = np.zeros(len(SPACE.identity))
    wanted[:4] = [1.0, -1.5, 0.7, 0.4]
    places = SPACE.person(wanted)[VERTICES]
    found = SPACE.identify(VERTICES, places, np.full(3, 0.05))
    np.testing.assert_allclose(found[:4], wanted[:4], atol=0.1)
