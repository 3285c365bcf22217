"""Laws of the sculptor: subdivision, handles, mirror images, and that what is shipped is what the
code sculpts."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mien.face.library import load_character
from mien.numeric.biharmonic import Handles, spread, uniform_laplacian
from mien.numeric.loop import subdivide
from mien.sculpt.acting.expression import Expression
from mien.sculpt.anatomy.cage import cage
from mien.sculpt.anatomy.head import Head, neutral_head
from mien.sculpt.anatomy.skull import mean_landmarks
from mien.sculpt.build import build_character
from mien.sculpt.cast import CAST
from mien.vocabulary import topology

_STEP = 0.001
"""mm: what a character file keeps of a displacement."""


@pytest.fixture(scope="module")
def head() -> Head:
    return neutral_head(CAST["generic"].proportions)


@pytest.mark.parametrize("name", ["generic", "woman", "toy"])
def test_what_is_shipped_is_what_the_code_sculpts(name: str) -> None:
    built, kept = build_character(name), load_character(name)
    assert built.keys.names == kept.keys.names
    assert built.examples == kept.examples
    assert [(p.name, p.first, p.last, p.follows) for p in built.face.parts] == [
        (p.name, p.first, p.last, p.follows) for p in kept.face.parts
    ]
    assert (built.face.triangles == kept.face.triangles).all()
    assert np.abs(built.face.vertices - kept.face.vertices).max() < 1e-4
    assert np.abs(built.keys.displacements - kept.keys.displacements).max() < 2 * _STEP
    # Depth tests on an edge may fall either way on another machine; the picture is the same.
    assert np.abs(built.face.occlusion - kept.face.occlusion).mean() < 0.005
    assert built.face.points.ids == kept.face.points.ids
    for place in ("head", "jaw", "eye_left", "eye_right"):
        assert np.allclose(built.face.pivots[place], kept.face.pivots[place])


def test_landmarks_are_their_own_mirror_image() -> None:
    assert (topology.MIRROR[topology.MIRROR] == np.arange(topology.LANDMARKS)).all()
    mean = mean_landmarks()
    assert (mean == mean[topology.MIRROR] * [-1, 1, 1]).all()
    turned = {frozenset(t) for t in topology.MIRROR[topology.TRIANGLES].tolist()}
    assert turned == {frozenset(t) for t in topology.TRIANGLES.tolist()}


def test_the_cage_is_closed_but_for_neck_and_eyes() -> None:
    mesh = cage()
    edges = np.sort(mesh.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, uses = np.unique(edges, axis=0, return_counts=True)
    assert set(uses.tolist()) == {1, 2}
    rim = set(np.unique(unique[uses == 1]).tolist())
    assert rim == set(mesh.rings[-1].tolist()) | set(mesh.lid_inner.ravel().tolist())


def test_subdivision_keeps_planes_and_vertices_first() -> None:
    mesh = cage()
    matrix, triangles = mesh.subdivision.matrix, mesh.subdivision.triangles
    assert np.allclose(matrix.sum(axis=1), 1.0)
    assert len(triangles) == 4 * len(mesh.triangles)
    # Each of the coarse triangle's corners keeps its number in one of the four.
    assert (np.sort(triangles[: len(mesh.triangles), 0]) == np.sort(mesh.triangles[:, 0])).all()


def test_subdivision_of_an_octahedron_shrinks_it_evenly() -> None:
    corners = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1.0]])
    faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
    fine = subdivide(np.array(faces, dtype=np.intp), 6).matrix @ corners
    # Warren: beta = 3 / (8 n), so a corner with four neighbours that sum to zero keeps 5/8.
    assert np.allclose(np.linalg.norm(fine[:6], axis=1), 5 / 8)
    assert np.allclose(np.linalg.norm(fine[6:], axis=1), np.hypot(3 / 8, 3 / 8))


@given(st.lists(st.floats(-5, 5), min_size=3, max_size=3))
@settings(max_examples=10, deadline=None)
def test_a_handle_on_everything_moves_everything(push: list[float]) -> None:
    triangles = cage().triangles
    handles = Handles(cage().count)
    handles.add(np.arange(cage().count), push, 1.0)
    moved = spread(uniform_laplacian(triangles, cage().count), handles, 0.05)
    assert np.allclose(moved, push, atol=1e-8)


def test_a_firm_handle_is_met_and_its_effect_fades() -> None:
    mesh = cage()
    handles = Handles(mesh.count)
    handles.hold(mesh.rings.ravel(), 50.0)
    handles.add([4], (0, 0, 5.0), 1e6)
    moved = spread(mesh.laplacian, handles, 0.06)
    assert np.allclose(moved[4], (0, 0, 5.0), atol=1e-3)
    assert np.linalg.norm(moved, axis=1).argmax() == 4
    assert np.abs(moved[152]).max() < 1.0


@given(
    left=st.floats(0, 1),
    right=st.floats(0, 1),
    jaw=st.floats(0, 15),
    blink=st.floats(-0.3, 1),
    aside=st.floats(-5, 5),
)
@settings(max_examples=12, deadline=None)
def test_sculpting_commutes_with_the_mirror(
    head: Head, left: float, right: float, jaw: float, blink: float, aside: float
) -> None:
    pose = Expression(
        left=left, right=right, jaw=jaw, blink=blink, lips_aside=aside, corner=(5, 6, -2)
    )
    there = head.posed(pose).skin
    back = head.posed(pose.mirrored()).skin[cage().fine_mirror] * [-1, 1, 1]
    assert np.abs(there - back).max() < 1e-6


def test_nothing_done_is_nothing_moved(head: Head) -> None:
    assert np.abs(head.posed(Expression()).skin - head.skin).max() < 1e-6
