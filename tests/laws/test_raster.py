"""The rasteriser against a plain twin, and the laws pictures must keep."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from mien.face.character import Character
from mien.numeric.normals import vertex_normals
from mien.numeric.raster import NOTHING, rasterize
from mien.view.camera import Camera
from mien.view.renderer import Renderer

SIZE = 48


def twin(screen: NDArray, triangles: NDArray, two_sided: NDArray) -> tuple[NDArray, NDArray]:
    """Nearness and distance to the nearest triangle edge of every sample, all triangles at once."""
    y, x = np.mgrid[:SIZE, :SIZE] + 0.5
    best, margin = np.zeros((SIZE, SIZE)), np.full((SIZE, SIZE), np.inf)
    for triangle, both in zip(triangles, two_sided, strict=True):
        a, b, c = screen[triangle].astype(float)
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area == 0 or (area > 0 and not both):
            continue
        v = ((x - a[0]) * (c[1] - a[1]) - (y - a[1]) * (c[0] - a[0])) / area
        w = ((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])) / area
        inside = np.minimum(np.minimum(v, w), 1 - v - w)
        z = a[2] + v * (b[2] - a[2]) + w * (c[2] - a[2])
        best = np.where((inside >= 0) & (z > best), z, best)
        longest = max(np.linalg.norm(a - b), np.linalg.norm(b - c), np.linalg.norm(c - a))
        margin = np.minimum(margin, np.abs(inside) * abs(area) / longest)
    return best, margin


@pytest.mark.parametrize("seed", range(6))
def test_nearest_surface_is_seen(seed: int) -> None:
    rng = np.random.default_rng(seed)
    screen = rng.uniform(-10, SIZE + 10, (60, 3)).astype(np.float32)
    screen[:, 2] = rng.uniform(0.5, 1.5, 60)
    triangles = rng.integers(0, 60, (40, 3)).astype(np.int32)
    two_sided = rng.random(40) < 0.5
    ids, nearness = rasterize(screen, triangles, two_sided, SIZE, SIZE)
    expected, margin = twin(screen, triangles, two_sided)
    clear = margin > 0.01
    assert clear.mean() > 0.8
    np.testing.assert_allclose(nearness[clear], expected[clear], atol=2e-3)
    assert np.array_equal(ids[clear] != NOTHING, expected[clear] > 0)


@pytest.mark.parametrize("angle", np.linspace(0.0, 1.5, 7))
def test_neighbours_leave_no_cracks(angle: float) -> None:
    """A turned sheet of small triangles covers every sample well inside it."""
    n = 40
    row, column = np.mgrid[: n + 1, : n + 1]
    sheet = (np.stack([column, row], -1).reshape(-1, 2) / n - 0.5) * 30.0
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    places = np.concatenate([sheet @ turn.T + SIZE / 2, np.ones((len(sheet), 1))], axis=1)
    corner = (row[:-1, :-1] * (n + 1) + column[:-1, :-1]).ravel()
    first = np.stack([corner, corner + n + 1, corner + 1], -1)
    second = np.stack([corner + 1, corner + n + 1, corner + n + 2], -1)
    triangles = np.concatenate([first, second]).astype(np.int32)
    ids, _ = rasterize(places, triangles, np.ones(len(triangles), bool), SIZE, SIZE)
    y, x = np.mgrid[:SIZE, :SIZE] + 0.5 - SIZE / 2
    inside = np.abs(np.stack([x, y], -1) @ turn).max(axis=-1) < 14.9
    assert (ids[inside] != NOTHING).all()
    outside = np.abs(np.stack([x, y], -1) @ turn).max(axis=-1) > 15.1
    assert (ids[outside] == NOTHING).all()


def test_what_is_off_the_picture_is_left_out() -> None:
    far = np.array([[1e6, 1e6, 1], [1e6 + 9, 1e6, 1], [1e6, 1e6 + 9, 1]], dtype=np.float32)
    everywhere = np.array([[-1e5, -1e5, 1], [-1e5, 3e5, 1], [3e5, -1e5, 1]], dtype=np.float32)
    triangle, both = np.array([[0, 1, 2]], dtype=np.int32), np.ones(1, bool)
    assert (rasterize(far, triangle, both, SIZE, SIZE)[0] == NOTHING).all()
    assert (rasterize(everywhere, triangle, both, SIZE, SIZE)[0] == 0).all()


def test_normals_of_a_ball_point_outwards(toy_face: Character) -> None:
    face, part = toy_face.face, toy_face.face.part("eye_left")
    normals = vertex_normals(face.vertices, part.triangles)[part.first : part.last]
    outwards = face.vertices[part.first : part.last] - face.pivots["eye_left"]
    outwards /= np.linalg.norm(outwards, axis=1, keepdims=True)
    assert (normals * outwards).sum(axis=1).min() > 0.9


def test_camera_sees_the_subjects_left_on_the_right() -> None:
    """From the front, +x is on the picture's right and +y above; nearer is larger."""
    camera = Camera(centre=(0.0, 0.0, 0.0), height=200.0, size=(100, 100))
    middle, left, up, near = camera.project(
        np.array([[0.0, 0, 0], [10, 0, 0], [0, 10, 0], [10, 0, 100]])
    )
    np.testing.assert_allclose(middle, [50, 50, 1], atol=1e-4)
    assert left[0] > 50
    assert up[1] < 50
    assert near[0] > left[0]
    assert near[2] > 1


def test_a_camera_on_the_left_sees_the_left_side() -> None:
    """Seen from the subject's left, the nose points to the picture's left."""
    camera = Camera(yaw=np.pi / 2, centre=(0.0, 0.0, 0.0))
    nose, ear = camera.project(np.array([[0.0, 0, 60], [60.0, 0, 0]]))
    assert nose[0] < 256
    np.testing.assert_allclose(ear[0], 256, atol=1e-3)


def test_rays_pass_through_what_is_projected() -> None:
    camera = Camera(yaw=0.4, pitch=0.2, size=(120, 90))
    place = np.array([[12.0, -30.0, 20.0]])
    x, y, _ = camera.project(place)[0]
    ray = np.array([x, y, 1.0]) @ camera.rays()
    toward = np.asarray(camera.centre) + camera.distance * camera.axes()[2] - place[0]
    cosine = ray @ toward / np.linalg.norm(ray) / np.linalg.norm(toward)
    np.testing.assert_allclose(cosine, 1.0, atol=1e-9)


@pytest.fixture(scope="module")
def renderer(toy_face: Character) -> Renderer:
    return Renderer(toy_face.face)


def test_a_picture_is_the_same_every_time(renderer: Renderer, toy_face: Character) -> None:
    camera = Camera(size=(96, 80))
    first = renderer.render(toy_face.face.vertices, camera)
    assert first.shape == (80, 96, 3)
    assert np.array_equal(first, renderer.render(toy_face.face.vertices, camera))


def test_edges_are_smooth(renderer: Renderer, toy_face: Character) -> None:
    """A picture is near the mean of one that is four times as fine."""
    camera = Camera(size=(64, 64))
    small = renderer.render(toy_face.face.vertices, camera).astype(float)
    fine = renderer.render(toy_face.face.vertices, replace(camera, size=(256, 256)))
    mean = fine.reshape(64, 4, 64, 4, 3).mean(axis=(1, 3))
    # One sample a pixel gives 1.26.
    assert np.abs(small - mean).mean() < 0.8


def test_a_vertex_that_is_nowhere_is_refused(renderer: Renderer, toy_face: Character) -> None:
    broken = toy_face.face.vertices.copy()
    broken[7, 1] = np.nan
    with pytest.raises(ValueError, match="not a number"):
        renderer.render(broken, Camera())
