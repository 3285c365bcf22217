"""Consistent parameterisation [Z] §2: a raw scan becomes the generic mesh in another shape.

Generic mesh, feature points, deformation by radial basis functions, Loop's subdivision twice,
projection onto the scan. A person's expressions are reached from the person's own neutral, which
is nearer than the generic mesh and slides less.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy import sparse

from mien.errors import InputError
from mien.face.face import Array
from mien.numeric import rbf
from mien.numeric.bending import bending, factor
from mien.numeric.procrustes import Similarity, align, rigid_part
from mien.scan.projection import PROJECTIONS, Aim, Flags, Pass, Settings, along_normals
from mien.scan.surface import Surface
from mien.scan.template import Template

_FEWEST = 8
"""Points below which a face's shape is a guess."""
_SMOOTHING = 0.1, 0.5
"""Of the radial basis functions: met exactly, points that lie close together crumple the mesh
wherever they mean something else than the template's by a millimetre. Of points placed by hand,
and of points found."""
_PULL = 3.0, 0.3
"""Weight of such points against bending; the scan has the last word."""
_FOUND = Settings(
    passes=(Pass(40.0, 10.0), Pass(20.0, 6.0), Pass(5.0, 4.0), Pass(1.0, 3.0)), pull=0.3
)
"""Where points are uncertain the scan's shape says more of what belongs where: a stiffer mesh
slides into it."""
_LOOSE = 1e-6
_CROOKED = 0.25
"""Rms miss of the points after alignment, of their spread, above which they are not a face's."""
_STILL_POINTS, _STILL_SKIN = 2.0, 0.5
"""mm by which points, and skin, of a head that has not moved may miss."""
_EXPRESSION = Settings(passes=(Pass(20.0, 10.0), Pass(10.0, 6.0), Pass(5.0, 4.0), Pass(3.0, 3.0)))
"""From the person's own neutral there is less to bend and more to lose by sliding."""


@dataclass(frozen=True, slots=True)
class ScanPoints:
    """Feature points on a scan."""

    ids: tuple[str, ...]
    """(N) FDP ids."""
    places: Array
    """(N, 3) mm in the scan's own axes."""
    found: bool = False
    """Whether a detector found them; False where somebody has placed or corrected them."""

    def of(self, ids: Sequence[str]) -> Array:
        """(M, 3) places of ``ids``. Raises KeyError."""
        row = dict(zip(self.ids, self.places, strict=True))
        return np.array([row[name] for name in ids])


@dataclass(frozen=True, slots=True)
class Parameterised:
    """A scan in the topology of its template, at each stage of [Z] figure 2; mm, scan's axes."""

    deformed: Array
    """(V, 3) the control mesh brought near the points."""
    subdivided: Array
    """(W, 3) refined."""
    vertices: Array
    """(W, 3) projected."""
    reliable: Flags
    """(W,) False where the surface is a smooth continuation and no measurement."""
    pose: Similarity
    """Takes the template's head frame to the scan's axes."""


def parameterise(
    template: Template, surface: Surface, points: ScanPoints, projection: str = "normals"
) -> Parameterised:
    """Bring ``template`` onto ``surface`` by its ``points``.

    ``projection`` is one of PROJECTIONS. Raises InputError where the points are too few or cannot
    be a face's.
    """
    matrix, rows = template.given(points.ids)
    _require_points(len(rows))
    goal = points.places[rows]
    rest = matrix @ template.vertices
    pose = align(rest, goal)
    _require_face(pose, rest, goal)
    placed = pose(template.vertices)
    deformed = placed + _toward(placed, template, matrix, goal - matrix @ placed, points.found)
    subdivided = template.refinement @ deformed
    aim = Aim(matrix, goal - matrix @ deformed)
    settings = _FOUND if points.found else Settings()
    done = PROJECTIONS[projection](subdivided, template, surface, aim, settings)
    return Parameterised(deformed, subdivided, done.vertices, done.reliable, pose)


def parameterise_expression(
    template: Template,
    neutral: Parameterised,
    neutral_points: ScanPoints,
    surface: Surface,
    points: ScanPoints,
) -> Parameterised:
    """Bring a person's ``neutral`` onto the scan of an expression of the same person.

    The points of both say how they moved, and what of the head did not move says how the head
    turned between the scans. Where the neutral was no measurement the expression is none either.
    Raises InputError where the two share too few points.
    """
    shared = [name for name in points.ids if name in neutral_points.ids]
    matrix, rows = template.given(tuple(shared))
    _require_points(len(rows))
    shared = [shared[row] for row in rows]
    before, goal = neutral_points.of(shared), points.of(shared)
    turn = rigid_part(before, goal, _STILL_POINTS)
    placed = turn(neutral.vertices)
    control = placed[: len(template.vertices)]
    motion = goal - turn(before)
    step = _toward(control, template, matrix, motion, points.found)
    start = placed + template.refinement @ step
    measured = replace(template, outside=template.outside & neutral.reliable)
    done = along_normals(start, measured, surface, Aim(matrix, motion - matrix @ step), _EXPRESSION)
    seen = done.reliable
    turn = rigid_part(neutral.vertices[seen], done.vertices[seen], _STILL_SKIN)
    pose = Similarity(
        neutral.pose.scale,
        turn.rotation @ neutral.pose.rotation,
        turn.rotation @ neutral.pose.shift + turn.shift,
    )
    return Parameterised(control + step, start, done.vertices, done.reliable, pose)


def _toward(
    placed: Array, template: Template, matrix: sparse.csr_matrix, missing: Array, found: bool
) -> Array:
    """(V, 3) motion of control vertices ``placed`` (V, 3) that brings their points (N, 3) near
    to where they are ``missing`` (N, 3) from.

    Radial basis functions act in space and cannot tell an upper lip from the lower one that
    touches it, so they only come near; what is left bends the mesh itself, on which the way from
    lip to lip is long.
    """
    step = rbf.fit(matrix @ placed, missing, smoothing=_SMOOTHING[found])(placed)
    pull = _PULL[found]
    plate = bending(template.vertices, template.triangles) + pull * matrix.T @ matrix
    left = matrix.T @ (missing - matrix @ step)
    loose = _LOOSE * sparse.identity(len(step))
    return np.asarray(step + factor(plate + loose).solve(pull * left))


def _require_points(count: int) -> None:
    if count < _FEWEST:
        raise InputError(
            f"{count} of the points can be used; {_FEWEST} are needed at least, over the whole face"
        )


def _require_face(pose: Similarity, rest: Array, goal: Array) -> None:
    spread = np.sqrt(((goal - goal.mean(axis=0)) ** 2).sum(axis=1).mean())
    miss = np.sqrt(((pose(rest) - goal) ** 2).sum(axis=1).mean())
    if miss > _CROOKED * spread:
        raise InputError(
            f"the points miss a face's by {miss:.0f} mm: two are swapped, or left and right are "
            "(left is the subject's)"
        )
