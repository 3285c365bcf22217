"""Scans become consistent meshes: the man, whose mesh is the generic face's, is the scan."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from mien.errors import InputError
from mien.face.face import Face
from mien.face.library import generic_face, load_character
from mien.face.mesh import Mesh
from mien.numeric.closest import nearest
from mien.numeric.loop import subdivide
from mien.numeric.rotation import from_vector
from mien.scan.bank import build_bank
from mien.scan.parameterise import ScanPoints, parameterise, parameterise_expression
from mien.scan.surface import Surface
from mien.scan.template import Template, face_template

pytest.importorskip("embreex")

TURN, SHIFT = from_vector(np.array([0.1, 0.3, -0.1])), np.array([20.0, -35.0, 60.0])
SKIN = generic_face().face.part("skin")


@cache
def template() -> Template:
    return face_template(generic_face().face, levels=1)


def scan(key: str | None = None, hole: float = 0.0) -> tuple[Mesh, ScanPoints]:
    """The man's skin and eyes, twice as dense, turned; without what is within ``hole`` mm of the
    left cheek."""
    man = load_character("man")
    places = man.face.vertices + (0.0 if key is None else man.keys[key])
    points = man.face.points
    ids = [name for name in points.ids if name in template().points.ids]
    known = points.at(places)[points.index(ids)]
    triangles = np.concatenate(
        [man.face.part(p).triangles for p in ("skin", "eye_left", "eye_right")]
    )
    step = subdivide(triangles.astype(np.intp), len(places))
    used, local = np.unique(step.triangles, return_inverse=True)
    dense = (step.matrix @ places)[used]
    mesh = Mesh(dense @ TURN.T + SHIFT, local.reshape(-1, 3).astype(np.int32))
    cheek = known[ids.index("5.3")]
    far = np.linalg.norm(dense - cheek, axis=1) > hole
    mesh = mesh.compact(far[mesh.triangles].all(axis=1))
    return mesh, ScanPoints(tuple(ids), known @ TURN.T + SHIFT)


def skin_of_man(key: str | None = None) -> np.ndarray:
    man: Face = load_character("man").face
    moved = man.vertices if key is None else man.vertices + load_character("man").keys[key]
    refined = template().refinement @ moved[SKIN.first : SKIN.last]
    return refined @ TURN.T + SHIFT


def off_surface(places: np.ndarray, mesh: Mesh) -> np.ndarray:
    triangle, weights = nearest(places, mesh.vertices, mesh.triangles)
    there = np.einsum("nk,nkx->nx", weights, mesh.vertices[mesh.triangles[triangle]])
    return np.linalg.norm(places - there, axis=1)


def test_the_mesh_comes_to_lie_on_the_scan_and_vertices_where_they_belong() -> None:
    mesh, points = scan()
    done = parameterise(template(), Surface(mesh), points)
    seen = done.reliable
    assert seen[template().outside].mean() > 0.9
    assert off_surface(done.vertices[seen], mesh).mean() < 0.05
    start = np.linalg.norm(done.subdivided - skin_of_man(), axis=1)[seen].mean()
    assert np.linalg.norm(done.vertices - skin_of_man(), axis=1)[seen].mean() < 0.8 * start


def test_the_cylinder_comes_near_but_not_as_near() -> None:
    mesh, points = scan()
    surface = Surface(mesh)
    upright = Mesh((mesh.vertices - SHIFT) @ TURN, mesh.triangles)
    standing = ScanPoints(points.ids, (points.places - SHIFT) @ TURN)
    around = parameterise(template(), Surface(upright), standing, "cylinder")
    along = parameterise(template(), surface, points)
    before = off_surface(around.subdivided[around.reliable], upright).mean()
    assert off_surface(around.vertices[around.reliable], upright).mean() < 0.2 * before
    both = around.reliable & along.reliable
    true = skin_of_man()
    missed = np.linalg.norm(around.vertices - (true - SHIFT) @ TURN, axis=1)[both].mean()
    assert missed > np.linalg.norm(along.vertices - true, axis=1)[both].mean()


def test_a_hole_is_continued_smoothly_and_told() -> None:
    mesh, points = scan(hole=9.0)
    keep = [row for row, name in enumerate(points.ids) if name != "5.3"]
    points = ScanPoints(tuple(points.ids[row] for row in keep), points.places[keep])
    done = parameterise(template(), Surface(mesh), points)
    whole, all_points = scan()
    cheek = all_points.places[all_points.ids.index("5.3")]
    inside = np.linalg.norm(done.vertices - cheek, axis=1) < 6.0
    assert inside.any()
    assert not done.reliable[inside].any()
    continued = off_surface(done.vertices[inside], whole)
    assert continued.mean() < 1.2
    assert continued.max() < 2.5


def test_what_moves_the_scan_moves_the_mesh() -> None:
    mesh, points = scan()
    here = parameterise(template(), Surface(mesh), points)
    turn = from_vector(np.array([-0.2, 0.5, 0.4]))
    moved = Mesh(mesh.vertices @ turn.T + 7.0, mesh.triangles)
    there = parameterise(
        template(), Surface(moved), ScanPoints(points.ids, points.places @ turn.T + 7.0)
    )
    both = here.reliable & there.reliable
    assert np.abs(here.vertices @ turn.T + 7.0 - there.vertices)[both].max() < 0.05


def test_an_expression_starts_from_the_neutral_and_the_head_is_held() -> None:
    (mesh, points), (smiling, moved) = scan(), scan("smile")
    rest = parameterise(template(), Surface(mesh), points)
    turn, shift = from_vector(np.array([0.0, -0.2, 0.1])), np.array([5.0, 3.0, -9.0])
    turned = Mesh(smiling.vertices @ turn.T + shift, smiling.triangles)
    goal = ScanPoints(moved.ids, moved.places @ turn.T + shift)
    done = parameterise_expression(template(), rest, points, Surface(turned), goal)
    true = (skin_of_man("smile") - skin_of_man()) @ rest.pose.rotation
    found = (done.vertices - done.pose.shift) @ done.pose.rotation
    found -= (rest.vertices - rest.pose.shift) @ rest.pose.rotation
    both = rest.reliable & done.reliable
    error = np.linalg.norm(found - true, axis=1)[both].mean()
    assert error < 0.35 * np.linalg.norm(true, axis=1)[both].mean()


def test_a_databank_is_a_face_that_acts() -> None:
    told: list[tuple[int, int]] = []
    bank = build_bank(
        generic_face(),
        "man",
        lambda: scan(),
        {"smile": lambda: scan("smile"), "jaw_open": lambda: scan("jaw_open")},
        lambda done, expected: told.append((done, expected)),
    )
    assert bank.names == ("smile", "jaw_open")
    assert told == [(1, 3), (2, 3), (3, 3)]
    face = bank.face
    assert np.abs(face.pivots["eye_left"] + face.pivots["eye_right"]).max() < 1e-9
    assert face.vertices[:, 1].max() > 60.0
    corner, chin = (face.points.index([name])[0] for name in ("8.3", "2.1"))
    smile, jaw = (face.points.at(motion) for motion in bank.displacements)
    assert smile[corner, 1] > 2.0
    assert jaw[chin, 1] < -5.0
    lower = face.part("teeth_lower")
    upper = face.part("teeth_upper")
    assert bank.displacements[1, lower.first : lower.last, 1].max() < -3.0
    assert not bank.displacements[1, upper.first : upper.last].any()


def test_points_that_are_no_face_are_told() -> None:
    mesh, points = scan()
    surface = Surface(mesh)
    with pytest.raises(InputError, match="are needed"):
        parameterise(template(), surface, ScanPoints(points.ids[:5], points.places[:5]))
    shuffled = np.random.default_rng(0).permutation(len(points.ids))
    swapped = ScanPoints(points.ids, points.places[shuffled])
    with pytest.raises(InputError, match="left and right"):
        parameterise(template(), surface, swapped)
    with pytest.raises(InputError, match="neutral"):
        build_bank(generic_face(), "man", scan, {})
