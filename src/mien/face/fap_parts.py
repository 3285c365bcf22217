"""How FAPs move what is not skin: teeth and tongue, eyeballs and pupils, ears, brows and lashes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from mien.face.face import Array, Face, Part
from mien.face.influence import Index, Mask, Surface, part_at, rows

TONGUE_TIP, TONGUE_BORDERS = "6.1", ("6.3", "6.4")
EARS = ("10.1", "10.2")
_ON_LOWER_JAW = ("teeth_lower", "gum_lower", "tongue")
_STANDS = ("teeth", "gum", "hair")
"""Parts of the head that no skin carries along."""
_ROOT = 0.35
"""Part of the tongue's length, from behind, that is grown fast."""
_TOUCHES = 2.5
"""mm between an ear and the skin it grows on."""
_NEAREST = 4
_STIFF = 2.5
"""mm over which brows and lashes move alike."""


def on_lower_jaw(face: Face) -> Mask:
    """(V,) lower teeth, gums and tongue."""
    return _together(face, [part for part in face.parts if part.name.startswith(_ON_LOWER_JAW)])


def jaw_motion(face: Face, chin: Array) -> Array:
    """(3, V, 3) what a bone does that goes with the jaw when the chin at ``chin`` (3,) goes 1 mm
    to the left, up, and forward: it slides, turns about the condyles (linearised), slides."""
    ray, arm = face.vertices - face.pivots["jaw"], chin - face.pivots["jaw"]
    motion = np.zeros((3, *face.vertices.shape))
    motion[0, :, 0] = 1.0
    motion[1, :, 1] = np.maximum(ray[:, 2], 0.0) / arm[2]
    motion[1, :, 2] = -ray[:, 1] / arm[2]
    motion[2, :, 2] = 1.0
    return motion


def tongue(face: Face) -> tuple[Part, Surface] | None:
    """The tongue and the surface over which its points' influence spreads; None without one."""
    part = _bearing(face, TONGUE_TIP)
    if part is None or not part.name.startswith("tongue"):
        return None
    depth = face.vertices[:, 2]
    mine = rows(face, part)
    back, tip = depth[mine].min(), face.point(TONGUE_TIP)[2]
    root = mine & (depth < back + _ROOT * (tip - back))
    return part, Surface(face.vertices, part.triangles, face.points, tip - back, root)


def curl(face: Face, part: Part) -> Array:
    """(V, 3) mm a radian: the borders of the tongue rise about its middle line, not its root."""
    lift = np.zeros_like(face.vertices)
    mine = rows(face, part)
    depth = face.vertices[:, 2]
    back, tip = depth[mine].min(), depth[mine].max()
    border = np.abs([face.point(fdp)[0] for fdp in TONGUE_BORDERS]).mean()
    free = np.clip((depth - back) / (tip - back) / _ROOT - 1.0, 0.0, 1.0)
    lift[mine, 1] = (face.vertices[mine, 0] ** 2 / border) * free[mine]
    return lift


def ears(face: Face, skin: Mask) -> list[Surface]:
    """The surfaces of ears that are parts of their own, held where they touch the ``skin``."""
    near = cKDTree(face.vertices[skin])
    found = []
    for fdp in EARS:
        part = _bearing(face, fdp)
        if part is None or skin[part.first]:
            continue
        touching = rows(face, part)
        touching[touching] = near.query(face.vertices[touching])[0] < _TOUCHES
        size = float(np.ptp(face.vertices[part.first : part.last, 1]))
        found.append(Surface(face.vertices, part.triangles, face.points, size, touching))
    return found


def eyeball(face: Face, side: int) -> Mask:
    """(V,) all that the left (0) or right eye carries."""
    name = ("eye_left", "eye_right")[side]
    return _together(face, [part for part in face.parts if part.follows == name])


def widened_pupil(face: Face, side: int, iris: float) -> Array:
    """(V, 3) mm for each mm that the pupil's diameter grows; ``iris`` is the iris' diameter, of
    which the pupil is a third at rest. What lies between slides along the ball."""
    ball = face.pivots[("eye_left", "eye_right")[side]]
    ray = face.vertices - ball
    out = np.linalg.norm(ray[:, :2], axis=1)
    pupil, edge = iris / 6.0, iris / 2.0
    grow = 0.5 * np.clip(np.minimum(out / pupil, (edge - out) / (edge - pupil)), 0.0, 1.0)
    grow *= eyeball(face, side) & (ray[:, 2] > 0.0)
    step = np.zeros_like(ray)
    step[:, :2] = ray[:, :2] * (grow / np.maximum(out, 1e-9))[:, None]
    step[:, 2] = -grow * out / np.maximum(ray[:, 2], 1e-9)
    return step


def cling(face: Face, fields: Array, skin: Mask) -> None:
    """Let brows, lashes, seams and the like follow the skin beneath them: fills their part of
    ``fields`` (N, V, 3)."""
    fixed = [part.name for part in face.parts if part.name.startswith((*_STANDS, *_ON_LOWER_JAW))]
    fixed += [ear.name for fdp in EARS if (ear := _bearing(face, fdp)) is not None]
    below = np.flatnonzero(skin)
    for part in face.parts:
        if part.follows != "head" or skin[part.first] or part.name in fixed:
            continue
        follow = _beneath(face, part, below)
        for field in fields:
            field[part.first : part.last] = follow @ field


def _beneath(face: Face, part: Part, skin: Index) -> sparse.csr_matrix:
    """(N, V) weights of the skin's vertices that each vertex of ``part`` follows. What is thinner
    than _STIFF bends with the skin and does not crumple."""
    places = face.vertices[part.first : part.last]
    distance, near = cKDTree(face.vertices[skin]).query(places, k=_NEAREST)
    row = np.repeat(np.arange(len(places)), _NEAREST)
    weight = 1.0 / np.maximum(distance, 1e-6).ravel() ** 2
    follow = sparse.csr_matrix(
        (weight, (row, skin[near].ravel())), (len(places), len(face.vertices))
    )
    tree = cKDTree(places)
    alike = tree.sparse_distance_matrix(tree, 2.5 * _STIFF, output_type="coo_matrix").tocsr()
    alike.data = np.exp(-((alike.data / _STIFF) ** 2))
    return _shares(alike) @ _shares(follow)


def _shares(weights: sparse.csr_matrix) -> sparse.csr_matrix:
    """``weights`` with rows that sum to 1."""
    return sparse.diags(1.0 / np.asarray(weights.sum(axis=1)).ravel()) @ weights


def _together(face: Face, parts: Sequence[Part]) -> Mask:
    """(V,) the vertices of ``parts``."""
    found = np.zeros(len(face.vertices), dtype=bool)
    for part in parts:
        found |= rows(face, part)
    return found


def _bearing(face: Face, fdp: str) -> Part | None:
    """The part on which a feature point lies."""
    if fdp not in face.points.ids:
        return None
    return part_at(face, int(face.points.vertices[face.points.index([fdp])[0], 0]))
