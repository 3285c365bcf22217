"""Laws of the capture, on a performer made of the generic face: no detector, exact truth."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mien.capture.descent import descend, first_pose
from mien.capture.headfit import (
    FRONTAL,
    FitSettings,
    HeadModel,
    fit_heads,
    motion_from_neutral,
    residuals,
)
from mien.capture.landmarks import GAIN, calibrate, perform
from mien.capture.lids import LidRange, closures, paired
from mien.capture.neutral import Ground, ground
from mien.capture.normal_equations import accumulate
from mien.capture.track import KEPT, ROW, LandmarkTrack
from mien.errors import InputError
from mien.face.library import generic_face
from mien.numeric.rotation import angle_between, from_vector
from mien.vocabulary.landmarks import FACE_LANDMARKS, IRIS, feature_points

FOCAL = 704.0
FRAMES = 90
REST = slice(20, 50)


def model(seed: int) -> HeadModel:
    random = np.random.default_rng(seed)
    return HeadModel(
        random.normal(size=(24, 3)) * 40.0, random.normal(size=(3, 24, 3)) * 4.0, np.arange(12)
    )


def linearize(model, rays, rotation, translation, weights):
    """The kernel's numpy twin: residual (F, N, 2) and its Jacobian (F, 6 + K, N, 2) in a left
    rotation increment about the head's origin, the translation and the weights."""
    frames, points, shapes = len(rays), len(model.neutral), len(model.shapes)
    back = np.swapaxes(rotation, 1, 2)
    shape = model.neutral + np.tensordot(weights, model.shapes, axes=1)
    turned = shape @ back
    place = turned + translation[:, None]
    residual = rays * place[..., 2:] - place[..., :2]
    jacobian = np.zeros((frames, 6 + shapes, points, 2))
    x, y, z = np.moveaxis(turned, -1, 0)
    # An increment omega moves a place by omega x (x, y, z).
    jacobian[:, 0] = rays * y[..., None]
    jacobian[:, 1] = rays * -x[..., None]
    jacobian[:, 0, :, 1] += z
    jacobian[:, 1, :, 0] -= z
    jacobian[:, 2, :, 0] = y
    jacobian[:, 2, :, 1] = -x
    jacobian[:, 3, :, 0] = -1.0
    jacobian[:, 4, :, 1] = -1.0
    jacobian[:, 5] = rays
    moved = (model.shapes.reshape(-1, 3) @ back).reshape(frames, shapes, points, 3)
    np.multiply(rays[:, None], moved[..., 2:], out=jacobian[:, 6:])
    jacobian[:, 6:] -= moved[..., :2]
    return residual, jacobian


def project(rotation, translation, shape):
    place = shape @ np.swapaxes(rotation, -1, -2) + translation[:, None]
    return place[..., :2] / place[..., 2:]


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000))
def test_jacobian_equals_central_differences(seed):
    random = np.random.default_rng(seed)
    face = model(seed)
    turn = from_vector(random.normal(size=(2, 3)) * 0.3) @ FRONTAL
    shift = np.array([[5.0, 3.0, 500.0], [-8.0, 1.0, 640.0]])
    weights = random.uniform(0, 1, (2, 3))
    rays = random.normal(size=(2, 24, 2)) * 0.1
    _, jacobian = linearize(face, rays, turn, shift, weights)
    step = 1e-5
    for column in range(9):
        change = np.zeros((2, 9))
        change[:, column] = step
        ends = [
            linearize(
                face,
                rays,
                from_vector(sign * change[:, :3]) @ turn,
                shift + sign * change[:, 3:6],
                weights + sign * change[:, 6:],
            )[0]
            for sign in (1, -1)
        ]
        numeric = (ends[0] - ends[1]) / (2 * step)
        np.testing.assert_allclose(jacobian[:, column], numeric, atol=1e-5)


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10_000))
def test_the_kernel_sums_what_its_twin_lays_out(seed):
    random = np.random.default_rng(seed)
    face = model(seed)
    turn = from_vector(random.normal(size=(3, 3)) * 0.3) @ FRONTAL
    shift = np.array([0.0, 0.0, 600.0]) + random.normal(size=(3, 3)) * 30.0
    weights = random.uniform(0, 1, (3, 3))
    rays = random.normal(size=(3, 24, 2)) * 0.1
    sigma, knee = 1.5, 2.5
    residual, jacobian = linearize(face, rays, turn, shift, weights)
    size2 = (residual**2).sum(-1, keepdims=True) / sigma**2
    trust = 1.0 / (1.0 + size2 / knee**2) / sigma**2
    flat = jacobian.reshape(3, 9, -1)
    trusted = (jacobian * trust[:, None]).reshape(3, 9, -1)
    shapes = np.ascontiguousarray(np.moveaxis(face.shapes, 0, 2))
    normal, right = accumulate(face.neutral, shapes, rays, turn, shift, weights, sigma, knee)
    np.testing.assert_allclose(normal, trusted @ np.swapaxes(flat, 1, 2), rtol=1e-9, atol=1e-9)
    wanted = -(trusted @ residual.reshape(3, -1, 1))[..., 0]
    np.testing.assert_allclose(right, wanted, rtol=1e-9, atol=1e-6)


def first_pose_twin(neutral, rays):
    """The first pose in array operations."""
    middle = rays.mean(1)
    lift = np.linalg.pinv(neutral - neutral.mean(0))
    axes = np.einsum("cn,fnd->fdc", lift, rays - middle[:, None])
    left, size, right = np.linalg.svd(axes, full_matrices=False)
    rows = left @ right
    rotation = np.concatenate([rows, np.cross(rows[:, :1], rows[:, 1:])], 1)
    depth = 1.0 / size.mean(1)
    place = np.concatenate([middle * depth[:, None], depth[:, None]], 1)
    return rotation, place - rotation @ neutral.mean(0)


def step_twin(normal, right, weights, precision, most):
    """One step under bounds in array operations."""
    inside = np.arange(6, normal.shape[-1])
    normal, right = normal.copy(), right.copy()
    right[:, 6:] -= precision * weights
    pressed = (weights <= 0.0) & (right[:, 6:] < 0.0) | (weights >= most) & (right[:, 6:] > 0.0)
    normal[:, inside, inside] += precision + 1e9 * pressed
    return np.linalg.solve(normal, right[..., None])[..., 0]


@settings(max_examples=10, deadline=None)
@given(st.integers(0, 10_000))
def test_the_descent_goes_where_its_twin_goes(seed):
    random = np.random.default_rng(seed)
    face = model(seed)
    turn = from_vector(random.normal(size=(3, 3)) * 0.2) @ FRONTAL
    shift = np.array([0.0, 0.0, 600.0]) + random.normal(size=(3, 3)) * 20.0
    weights = random.choice([0.0, 0.4, 1.2], (3, 3))
    rays = project(turn, shift, face.neutral + random.normal(size=face.neutral.shape))
    for found, wanted in zip(
        first_pose(face.neutral, rays), first_pose_twin(face.neutral, rays), strict=True
    ):
        np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9)
    arrays = face.neutral, face.by_point, rays
    step = step_twin(*accumulate(*arrays, turn, shift, weights, 1.0, 2.5), weights, 10.0, 1.2)
    wanted = from_vector(step[:, :3]) @ turn, shift + step[:, 3:6]
    pose, found = (turn.copy(), shift.copy()), weights.copy()
    descend(*arrays, *pose, found, (1.0, 2.5), (10.0, 1.2), 1)
    np.testing.assert_allclose(pose[0], wanted[0], atol=1e-9)
    np.testing.assert_allclose(pose[1], wanted[1], atol=1e-6)
    np.testing.assert_allclose(found, np.clip(weights + step[:, 6:], 0.0, 1.2), atol=1e-9)


@settings(max_examples=20, deadline=None)
@given(st.integers(0, 10_000))
def test_pose_and_weights_of_an_exact_picture_are_found(seed):
    random = np.random.default_rng(seed)
    face = model(seed)
    turn = from_vector(random.normal(size=(4, 3)) * 0.2) @ FRONTAL
    shift = np.array([0.0, 0.0, 600.0]) + random.normal(size=(4, 3)) * 20.0
    weights = random.uniform(0.1, 0.9, (4, 3))
    rays = project(turn, shift, face.neutral + np.tensordot(weights, face.shapes, axes=1))
    fit = fit_heads(face, rays, FitSettings(weight_sigma=100.0, rounds=10))
    np.testing.assert_allclose(fit.weights, weights, atol=1e-3)
    assert np.degrees(angle_between(turn, fit.rotation)).max() < 0.02


def test_a_frame_alone_gives_what_it_gives_among_others():
    random = np.random.default_rng(3)
    face = model(3)
    rays = project(
        from_vector(random.normal(size=(6, 3)) * 0.2) @ FRONTAL,
        np.tile([0.0, 0.0, 600.0], (6, 1)),
        face.neutral,
    )
    together = fit_heads(face, rays)
    for frame in range(6):
        alone = fit_heads(face, rays[frame : frame + 1])
        np.testing.assert_allclose(alone.rotation[0], together.rotation[frame], atol=1e-9)
        np.testing.assert_allclose(alone.weights[0], together.weights[frame], atol=1e-9)


def test_motion_holds_nothing_along_the_camera():
    random = np.random.default_rng(5)
    face = model(5)
    turn = from_vector(np.array([[0.1, 0.4, 0.0]])) @ FRONTAL
    moved = face.neutral + random.normal(size=face.neutral.shape)
    rays = project(turn, np.array([[0.0, 0.0, 600.0]]), moved)
    fit = fit_heads(face, rays)
    motion = motion_from_neutral(face.neutral, rays, fit)
    np.testing.assert_allclose(motion @ fit.rotation[0, 2], 0.0, atol=1e-9)


# A whole take of a performer who is the generic face.


@pytest.fixture(scope="module")
def base() -> Ground:
    return ground(generic_face())


def act(base: Ground, shape: str | None = None) -> LandmarkTrack:
    """A take: resting in REST, one shape swelling outside it, the head swaying."""
    names = list(generic_face().examples)
    level = np.zeros((FRAMES, len(names)))
    swell = np.sin(np.linspace(0.0, 3.0 * np.pi, FRAMES)) ** 2
    swell[REST] = 0.0
    if shape is not None:
        level[:, names.index(shape)] = swell
    yaw = 0.3 * np.sin(np.arange(FRAMES) / 9.0)
    yaw[REST] = 0.0
    zero = np.zeros(FRAMES)
    turn = FRONTAL @ from_vector(np.stack([0.3 * yaw, yaw, zero], 1))
    face = base.neutral + np.tensordot(level, base.shapes, axes=1)
    places = np.empty((FRAMES, len(KEPT), 3))
    places[:, : face.shape[1]] = face
    for side, iris in zip((1.0, -1.0), IRIS, strict=True):
        places[:, ROW[iris]] = (side * 31.5, 0.0, 20.0)
    seen = places @ np.swapaxes(turn, 1, 2) + np.array([3.0, -2.0, 560.0])
    points = np.empty(seen.shape, dtype=np.float32)
    points[..., :2] = seen[..., :2] / seen[..., 2:] * FOCAL + [320.0, 240.0]
    points[..., 2] = (seen[..., 2] - 560.0) * FOCAL / 560.0
    return LandmarkTrack(np.arange(FRAMES) / 30.0, points, np.zeros(FRAMES, dtype=bool), (640, 480))


def read(track: LandmarkTrack, base: Ground):
    return perform(track, calibrate(track, base), base, "made")


def test_kept_landmarks_of_the_face_come_first():
    assert all(i < FACE_LANDMARKS for i in KEPT[: -len(IRIS)])
    assert KEPT[-2:] == IRIS


@pytest.mark.parametrize("shape", ["smile", "jaw_open", "brows_up", "pucker"])
def test_motion_of_a_known_take_is_read(base, shape):
    track = act(base, shape)
    performance = read(track, base)
    names = list(generic_face().examples)
    swell = np.sin(np.linspace(0.0, 3.0 * np.pi, FRAMES)) ** 2
    swell[REST] = 0.0
    field = base.shapes[names.index(shape)][[ROW[i] for i in feature_points().values()]]
    true = swell[:, None, None] * field
    motion = performance.motion / GAIN[:, None]
    error = np.linalg.norm((motion - true)[..., :2], axis=-1).mean()
    assert error < 0.4 * np.linalg.norm(true[..., :2], axis=-1).mean()


def test_the_head_is_read_where_nothing_moves(base):
    track = act(base)
    performance = read(track, base)
    yaw = np.arctan2(performance.rotation[:, 0, 2], performance.rotation[:, 2, 2])
    wanted = 0.3 * np.sin(np.arange(FRAMES) / 9.0)
    wanted[REST] = 0.0
    np.testing.assert_allclose(yaw, wanted, atol=np.radians(0.5))
    assert np.abs(performance.motion / GAIN[:, None]).max() < 0.5


def test_a_blink_of_one_eye_is_a_closure_of_that_eye(base):
    performance = read(act(base, "blink_left"), base)
    assert performance.scalars["lid_left"].max() > 0.9
    assert performance.scalars["lid_right"].max() < 0.3
    assert np.abs(performance.scalars["lid_left"][REST]).max() < 0.05


def test_a_frame_read_live_equals_the_frame_in_its_take(base):
    track = act(base, "smile")
    known = calibrate(track, base)
    whole = perform(track, known, base, "made")
    for frame in (0, 31, 70):
        span = slice(frame, frame + 1)
        one = LandmarkTrack(track.time[span], track.points[span], track.lost[span], track.size)
        alone = perform(one, known, base, "made")
        np.testing.assert_allclose(alone.motion[0], whole.motion[frame], atol=1e-6)
        np.testing.assert_allclose(alone.rotation[0], whole.rotation[frame], atol=1e-6)
        np.testing.assert_allclose(alone.gaze[0], whole.gaze[frame], atol=1e-6)
        np.testing.assert_allclose(alone.head()[1][0], whole.head()[1][frame], atol=1e-6)


def test_frames_without_a_face_are_lost_and_repeat_the_last(base):
    track = act(base, "smile")
    lost = track.lost.copy()
    lost[[0, 1, 60, 61, 89]] = True
    points = np.where(lost[:, None, None], 0.0, track.points).astype(np.float32)
    performance = read(LandmarkTrack(track.time, points, lost, track.size), base)
    assert (performance.lost == lost).all()
    assert (performance.confidence[lost] == 0.0).all()
    np.testing.assert_array_equal(performance.motion[61], performance.motion[59])
    np.testing.assert_array_equal(performance.motion[0], performance.motion[2])
    assert np.isfinite(performance.motion).all()


def test_a_neutral_named_where_nobody_is_seen_is_refused(base):
    with pytest.raises(InputError, match="--neutral"):
        calibrate(act(base), base, neutral=(50.0, 51.0))


def test_size_of_the_picture_does_not_matter(base):
    track = act(base, "smile")
    double = LandmarkTrack(track.time, track.points * 2.0, track.lost, (1280, 960))
    one, two = read(track, base), read(double, base)
    np.testing.assert_allclose(one.motion, two.motion, atol=1e-3)


def test_closure_is_monotone_and_calibrated():
    span = LidRange(np.array([0.3, 0.3]), np.array([0.1, 0.1]))
    opening = np.repeat(np.linspace(0.32, 0.08, 60)[:, None], 2, axis=1)
    closure = closures(opening, span, np.zeros(60))
    assert (np.diff(closure, axis=0) >= 0).all()
    np.testing.assert_allclose(closures(span.open[None], span, np.zeros(1)), 0.0, atol=1e-12)
    assert closures(span.shut[None], span, np.zeros(1)).min() >= 1.0


def test_the_far_eye_of_a_turned_head_follows_the_near_one():
    span = LidRange(np.array([0.3, 0.3]), np.array([0.1, 0.1]))
    opening = np.array([[0.1, 0.3]])
    turned = closures(opening, span, np.array([np.radians(40.0)]))
    np.testing.assert_allclose(turned[0, 0], turned[0, 1])


def test_eyes_that_differ_by_less_than_a_pixel_go_together():
    closure = np.array([[0.4, 0.9], [0.0, 1.0], [0.2, 0.2]])
    small = paired(closure, np.full((3, 2), 2.0))
    np.testing.assert_allclose(small, [[0.65, 0.65], [0.25, 0.75], [0.2, 0.2]])
    large = paired(closure, np.full((3, 2), 100.0))
    np.testing.assert_allclose(large, closure, atol=0.005001)
    np.testing.assert_allclose(paired(closure[:, ::-1], np.full((3, 2), 2.0)), small[:, ::-1])


def test_the_residual_alone_is_the_residual_of_the_jacobian():
    random = np.random.default_rng(9)
    face = model(9)
    rays = random.normal(size=(3, 24, 2)) * 0.1
    fit = fit_heads(face, rays)
    whole, _ = linearize(face, rays, fit.rotation, fit.translation, fit.weights)
    np.testing.assert_allclose(residuals(face, rays, fit), whole, atol=1e-9)
