"""Consistent parameterisation [Z] §2: a raw scan becomes the generic mesh in another shape.

Generic mesh, feature points, deformation by radial basis functions, Loop's subdivision twice,
projection onto the scan.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from mien.errors import InputError
from mien.face.face import Array
from mien.numeric import rbf
from mien.numeric.bending import bending, factor
from mien.numeric.procrustes import Similarity, align
from mien.scan.projection import PROJECTIONS, Aim, Flags
from mien.scan.surface import Surface
from mien.scan.template import Template

_FEWEST = 8
"""Points below which a face's shape is a guess."""
_SMOOTHING = 0.1
"""Of the radial basis functions: met exactly, points that lie close together crumple the mesh
wherever they mean something else than the template's by a millimetre."""
_PULL = 3.0
"""Weight of the points against bending; the scan has the last word."""
_LOOSE = 1e-6
_CROOKED = 0.25
"""Rms miss of the points after alignment, of their spread, above which they are not a face's."""


@dataclass(frozen=True, slots=True)
class ScanPoints:
    """Feature points on a scan."""

    ids: tuple[str, ...]
    """(N) FDP ids."""
    places: Array
    """(N, 3) mm in the scan's own axes."""


@dataclass(frozen=True, slots=True)
class Parameterised:
    """A scan in the topology of its template, at each stage of [Z] figure 2; mm, scan's axes."""

    deformed: Array
    """(V, 3) the control mesh after the radial basis functions."""
    subdivided: Array
    """(W, 3) refined."""
    vertices: Array
    """(W, 3) projected."""
    reliable: Flags
    """(W,) False where the surface is a smooth continuation and no measurement."""
    scan_from_head: Similarity
    """Takes the template's rest to the scan."""


def parameterise(
    template: Template, surface: Surface, points: ScanPoints, projection: str = "normals"
) -> Parameterised:
    """Bring ``template`` onto ``surface`` by its ``points``.

    ``projection`` is one of PROJECTIONS. Raises InputError where the points are too few or cannot
    be a face's.
    """
    matrix, rows = template.given(points.ids)
    if len(rows) < _FEWEST:
        raise InputError(
            f"{len(rows)} of the points lie on the template; {_FEWEST} are needed at least, "
            "spread over the face"
        )
    goal = points.places[rows]
    rest = matrix @ template.vertices
    pose = align(rest, goal)
    _require_face(pose, rest, goal)
    deformed = deform(pose(template.vertices), template, matrix, goal)
    subdivided = template.refinement @ deformed
    aim = Aim(matrix, goal - matrix @ deformed)
    done = PROJECTIONS[projection](subdivided, template, surface, aim)
    return Parameterised(deformed, subdivided, done.vertices, done.reliable, pose)


def deform(placed: Array, template: Template, matrix: sparse.csr_matrix, goal: Array) -> Array:
    """(V, 3) control vertices ``placed`` (V, 3), brought near the points' ``goal`` (N, 3).

    Radial basis functions act in space and cannot tell an upper lip from the lower one that
    touches it, so they only come near; what is missing bends the mesh itself, where the way from
    lip to lip is long.
    """
    field = rbf.fit(matrix @ placed, goal - matrix @ placed, smoothing=_SMOOTHING)
    near = placed + field(placed)
    plate = bending(template.vertices, template.triangles) + _PULL * matrix.T @ matrix
    missing = matrix.T @ (goal - matrix @ near)
    loose = _LOOSE * sparse.identity(len(near))
    return np.asarray(near + factor(plate + loose).solve(_PULL * missing))


def _require_face(pose: Similarity, rest: Array, goal: Array) -> None:
    spread = np.sqrt(((goal - goal.mean(axis=0)) ** 2).sum(axis=1).mean())
    miss = np.sqrt(((pose(rest) - goal) ** 2).sum(axis=1).mean())
    if miss > _CROOKED * spread:
        raise InputError(
            f"the points miss a face's by {miss:.0f} mm: two are swapped, or left and right are "
            "(left is the subject's)"
        )
