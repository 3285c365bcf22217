"""Energies, kernels and the network of the curve capture against what they must equal."""

from __future__ import annotations

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from mien.capture.snakes.colour.network import Lesson, Network, error, train, untrained
from mien.capture.snakes.colour.pigments import pigments
from mien.capture.snakes.colour.skin import USUAL_SKIN, gains
from mien.capture.snakes.colour.transform import Weights, channels, contrast, transform
from mien.capture.snakes.curves.energy import HALF_STEP, SAMPLES, Terms, descend, energy, packed
from mien.capture.snakes.curves.features import usual_lenses
from mien.capture.snakes.curves.fields import Look, look_at
from mien.capture.snakes.curves.lens import LOWER, UPPER, height, tallness
from mien.capture.snakes.head.patch import COARSE, HEIGHT, WIDTH
from mien.capture.snakes.head.pose import RESTING, Pose, fit_pose
from mien.numeric.bezier import bernstein, bernstein_slope, curve, fit
from mien.numeric.rotation import from_vector

Array = NDArray[np.float64]
CORNER = np.array([0.0, -65.0])
BOX = (-66, 80, 66, 189)


def some_field(seed: int) -> NDArray[np.float32]:
    noise = np.random.default_rng(seed).random((60, 110)).astype(np.float32)
    return np.asarray(cv2.GaussianBlur(noise, (0, 0), 3.0)) * 3.0


def some_lens(random: np.random.Generator) -> Array:
    return usual_lenses()["brow_left"] + random.normal(0.0, 2.0, (6, 2))


def some_prior(random: np.random.Generator) -> tuple[Array, Array]:
    root = random.normal(0.0, 0.01, (12, 12))
    return root @ root.T, random.normal(0.0, 0.01, 12)


@pytest.mark.parametrize("pitch", [1.0, 2.0])
@pytest.mark.parametrize("seed", range(8))
def test_the_gradient_of_the_energy_is_its_slope(seed: int, pitch: float) -> None:
    random = np.random.default_rng(seed)
    lens, field = some_lens(random), some_field(seed)
    terms = Terms(edge=1.3, outside=0.9, inside=1.1, reach=3.3, least_width=90.0, pitch=pitch)
    prior = some_prior(random)
    _, gradient = energy(lens, field, CORNER, terms, *prior)
    slope, step = np.empty((6, 2)), 1e-5
    for i in range(6):
        for j in range(2):
            ahead, behind = lens.copy(), lens.copy()
            ahead[i, j] += step
            behind[i, j] -= step
            up = energy(ahead, field, CORNER, terms, *prior)[0]
            slope[i, j] = (up - energy(behind, field, CORNER, terms, *prior)[0]) / (2.0 * step)
    assert np.abs(gradient - slope).max() < 1e-5 * np.abs(slope).max()


def plain_energy(lens: Array, field: Array, terms: Terms, quadratic: Array, linear: Array) -> float:
    """[B] eqs. 2-4 in NumPy."""
    at = (np.arange(SAMPLES) + 0.5) / SAMPLES

    def look(places: Array) -> Array:
        x = np.clip((places[:, 0] - CORNER[0]) / terms.pitch, 0, field.shape[1] - 1.000001)
        y = np.clip((places[:, 1] - CORNER[1]) / terms.pitch, 0, field.shape[0] - 1.000001)
        i, j, f, g = y.astype(int), x.astype(int), y % 1.0, x % 1.0
        above = field[i, j] * (1 - g) + field[i, j + 1] * g
        below = field[i + 1, j] * (1 - g) + field[i + 1, j + 1] * g
        return np.asarray(above * (1 - f) + below * f)

    total, middle = 0.0, []
    for edge, inward in ((UPPER, 1.0), (LOWER, -1.0)):
        place, slope = bernstein(at) @ lens[edge], bernstein_slope(at) @ lens[edge]
        along = slope / np.linalg.norm(slope, axis=1, keepdims=True)
        normal = inward * np.stack([-along[:, 1], along[:, 0]], axis=1)
        step = HALF_STEP * normal
        rise = np.maximum(look(place + step) - look(place - step), 0.0) / (2.0 * HALF_STEP)
        outer, inner = look(place - terms.reach * normal), look(place + terms.reach * normal)
        total += float(
            (terms.outside * outer - terms.inside * inner - terms.edge * rise**2).mean() / 2.0
        )
        middle.append(place)
    crossed = np.minimum(middle[1][:, 1] - middle[0][:, 1], 0.0)
    missing = max(terms.least_width - (lens[1, 0] - lens[0, 0]), 0.0)
    flat = lens.reshape(12)
    prior = float(flat @ quadratic @ flat - 2.0 * linear @ flat)
    return total + 0.02 * float((crossed**2).mean()) + 0.01 * missing**2 + prior


@pytest.mark.parametrize("pitch", [1.0, 2.0])
@pytest.mark.parametrize("seed", range(8))
def test_the_energy_kernel_equals_its_numpy_twin(seed: int, pitch: float) -> None:
    random = np.random.default_rng(seed)
    lens, field, prior = some_lens(random), some_field(seed), some_prior(random)
    terms = Terms(reach=2.5, least_width=75.0, pitch=pitch)
    twin = plain_energy(lens, field.astype(float), terms, *prior)
    assert energy(lens, field, CORNER, terms, *prior)[0] == pytest.approx(twin, abs=2e-5)


def test_descent_never_goes_uphill_and_finds_a_bright_lens() -> None:
    wanted = usual_lenses()["brow_left"]
    field = np.zeros((60, 110), np.float32)
    outline = np.concatenate([curve(wanted[UPPER], 30), curve(wanted[LOWER], 30)[::-1]])
    cv2.fillPoly(field, [np.round(outline - CORNER).astype(np.int32)], 1.0)
    field = np.asarray(cv2.GaussianBlur(field, (0, 0), 2.0))
    start = (wanted + np.array([3.0, 4.0])).reshape(12)
    nothing = np.zeros((12, 12)), np.zeros(12)
    terms, values = packed(Terms(reach=2.0)), []
    place = start
    for _ in range(8):
        place, value = descend(place, field, CORNER, terms, *nothing, 10, 2.0)
        values.append(value)
    assert (np.diff(values) <= 1e-9).all()
    middle = [curve(lens[UPPER], 21)[3:-3] for lens in (place.reshape(6, 2), wanted)]
    assert np.abs(middle[0][:, 1] - middle[1][:, 1]).mean() < 1.5


@pytest.mark.parametrize("pitch", [1, COARSE])
def test_the_colour_kernel_equals_its_numpy_twin(pitch: int) -> None:
    look, gains = some_look(), np.array([1.2, 0.9, 1.1])
    assert np.allclose(look.value, (look.small * gains).max(axis=2), atol=1e-3)
    weights = Weights(0.2, 0.3, -0.4, 0.5, 0.1), Weights(-0.5, 0.0, 0.0, 0.0, 0.05)
    kernel = transform(look.at(pitch), gains, look.mean, weights, BOX, pitch)
    parts = channels(look.at(pitch), gains, look.mean, BOX, pitch)
    rows = np.array([[0.2, 0.3, -0.4, 0.5], [-0.5, 0.0, 0.0, 0.0]])
    twin = contrast((parts @ rows.T + np.array([0.1, 0.05])).max(axis=-1))
    # The kernel looks logarithm, hue and contrast up in tables of a thousand steps.
    assert np.abs(kernel - twin).max() < 0.06
    assert np.abs(kernel - twin).mean() < 0.006


def test_the_pigment_kernel_equals_its_numpy_twin() -> None:
    look, gains = some_look(), np.array([1.2, 0.9, 1.1])
    columns, rows = slice(46, 178), slice(155, 264)
    seen = pigments(look.patch, gains, (46, 155, 178, 264), 1)
    scaled = (look.patch * gains)[rows, columns]
    assert np.allclose(seen.value, scaled.max(axis=2), atol=1e-3)
    assert np.allclose(seen.magenta, 1.0 - scaled[..., 1] / scaled.max(axis=2), atol=1e-4)
    assert np.allclose(seen.blue, scaled[..., 2] / scaled[..., 1], rtol=1e-4)
    assert np.array_equal(seen.pixels(np.array([-66.0, 80.0])), [0.0, 0.0])


def some_look() -> Look:
    random = np.random.default_rng(3)
    noise = random.integers(20, 235, (HEIGHT, WIDTH, 3), dtype=np.uint8)
    patch = np.asarray(cv2.GaussianBlur(noise, (0, 0), 2.0))
    return look_at(patch, gains(USUAL_SKIN / np.array([1.2, 0.9, 1.1])))


def test_features_are_darker_than_skin() -> None:
    with pytest.raises(ValueError, match="not positive"):
        Weights(0.0, 0.0, 0.1, 0.0, 0.0)


def some_lesson(random: np.random.Generator) -> Lesson:
    seen = random.normal(size=(200, 4))
    wanted = (seen @ np.array([0.5, 1.0, -0.7, 0.2]) > 0.3).astype(float)
    return Lesson(random.uniform(40, 250, 11), seen, wanted, np.full(200, 1.0 / 200))


def numbers(network: Network) -> list[Array]:
    return [network.hidden, network.hidden_bias, network.output, network.output_bias]


def test_back_propagation_is_the_slope_of_the_error() -> None:
    random = np.random.default_rng(5)
    lesson = some_lesson(random)
    network = untrained(np.array([0.1, 0.2, -0.3, 0.4]), 0.1)
    network = Network(
        network.hidden,
        random.normal(size=10),
        random.normal(size=(4, 10)),
        network.output_bias,
        network.constant,
    )
    _, gradient = error(network, lesson)
    for layer, (values, slopes) in enumerate(zip(numbers(network), numbers(gradient), strict=True)):
        for place in random.integers(0, values.size, 6):
            index = np.unravel_index(place, values.shape)
            change = []
            for step in (1e-5, -1e-5):
                moved = [each.copy() for each in numbers(network)]
                moved[layer][index] += step
                change.append(error(Network(*moved, network.constant), lesson)[0])
            slope = (change[0] - change[1]) / 2e-5
            assert slopes[index] == pytest.approx(slope, rel=1e-5, abs=1e-9)


def test_training_lowers_the_error() -> None:
    random = np.random.default_rng(6)
    lessons = [some_lesson(random) for _ in range(4)]
    before = untrained(np.zeros(4), 0.5)
    after = train(before, lessons)
    assert np.mean([error(after, each)[0] for each in lessons]) < 0.5 * np.mean(
        [error(before, each)[0] for each in lessons]
    )


def test_the_pose_is_found_again() -> None:
    random = np.random.default_rng(7)
    rest = random.uniform(-60, 60, (40, 3))
    true = Pose(from_vector(np.array([0.1, -0.25, 0.15])), 1.08, np.array([3.0, -2.0]))
    seen = true(rest)
    seen[:4] += 30.0
    found = RESTING
    for _ in range(12):
        found = fit_pose(rest, seen, np.ones(40), np.full(40, 4.0), found)
    assert np.abs(found(rest[4:]) - seen[4:]).max() < 0.3
    back, level = true.levelled()
    assert np.allclose(true(rest) @ back[:, :2].T + back[:, 2], level(rest))
    assert abs(level.rotation[1, 0]) < 1e-9


def test_bezier_curves_pass_through_their_own_places() -> None:
    random = np.random.default_rng(8)
    control = np.sort(random.uniform(0, 50, (4, 2)), axis=0)
    assert np.allclose(bernstein(np.linspace(0, 1, 9)).sum(axis=1), 1.0)
    assert np.allclose(bernstein_slope(np.linspace(0, 1, 9)).sum(axis=1), 0.0)
    places = curve(control, 31)
    again = curve(fit(places), 301)
    away = np.linalg.norm(places[:, None] - again, axis=-1).min(axis=1)
    assert away.max() < 0.5


@pytest.mark.parametrize("name", usual_lenses())
def test_the_height_kernel_equals_its_numpy_twin(name: str) -> None:
    lens = usual_lenses()[name]
    assert tallness(lens) == pytest.approx(float(height(lens)), abs=1e-9)
