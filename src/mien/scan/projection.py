"""A mesh that lies near a scan is brought onto it.

Along the normals: in several passes, each vertex looks for the scan straight before and behind it,
and the mesh follows as a plate that bends less and less stiffly. What finds no surface it can
trust (holes, teeth, overhangs, the inside of the mouth) is carried along by the plate.

    minimise  sum_i w_i (n_i · (S d)_i - h_i)² + stiffness |d|²_bending + pull sum_j |P_j d - m_j|²

d (V, 3) moves the control mesh, S refines it, n_i is the scan's normal where vertex i met it, h_i
how far along it the scan lies, P_j d the motion of feature point j and m_j what it still misses. A
point may slide in the scan's plane, which holds it where it belongs sideways better than moving it
along its own normal alone. At last the refined vertices go along their normals, singly but for
what keeps noise out.

Around a cylinder, as [Z] §2 has it: each vertex goes towards or away from a vertical axis.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import LinearOperator, cg

from mien.face.face import Array
from mien.numeric.bending import bending, factor
from mien.numeric.normals import vertex_normals
from mien.scan.surface import Surface
from mien.scan.template import Template

Flags = NDArray[np.bool_]

_FACING = 0.6
"""Least cosine between a vertex's normal and that of the surface it goes to."""
_TOLERANCE, _MOST_STEPS = 1e-4, 80
"""Of the conjugate gradients."""
_SEAM = 0.01
"""Weight, against 1, of a refined vertex that met nothing staying where the plate took it."""
_LOOSE = 1e-6
"""Weight of staying, for what nothing else holds."""


@dataclass(frozen=True, slots=True)
class Pass:
    """One round of looking and following."""

    stiffness: float
    reach: float
    """mm a vertex looks along its normal, either way."""


@dataclass(frozen=True, slots=True)
class Settings:
    """How a mesh follows a scan."""

    passes: tuple[Pass, ...] = (Pass(5.0, 10.0), Pass(2.0, 6.0), Pass(0.7, 4.0), Pass(0.25, 3.0))
    pull: float = 3.0
    """Weight of a feature point, against 1 for a control vertex that met the scan."""
    last: Pass = Pass(0.1, 3.0)
    """Of the refined vertices."""


@dataclass(frozen=True, slots=True)
class Projected:
    """A refined mesh on a scan."""

    vertices: Array
    """(W, 3) mm."""
    reliable: Flags
    """(W,) True where the scan was met; elsewhere the surface is a smooth continuation."""


@dataclass(frozen=True, slots=True)
class Aim:
    """Where feature points should come to lie."""

    matrix: sparse.csr_matrix
    """(N, V) takes control vertices to the points."""
    missing: Array
    """(N, 3) mm each is off at the start."""


Projection = Callable[[Array, Template, Surface, Aim, Settings], Projected]


def along_normals(
    start: Array, template: Template, surface: Surface, aim: Aim, settings: Settings
) -> Projected:
    """Bring the refined vertices ``start`` (W, 3) onto ``surface``."""
    refine, back = template.refinement, template.refinement.T.tocsr()
    bend = bending(start[: len(template.vertices)], template.triangles)
    pull = (settings.pull * aim.matrix.T @ aim.matrix).tocsr()
    share = 1.0 / (refine.shape[0] / refine.shape[1])
    places, missing = start, aim.missing
    for stage in settings.passes:
        met = _look(places, template, surface, stage.reach)
        weight = share * met.found
        plate = stage.stiffness * bend + pull + _LOOSE * sparse.identity(refine.shape[1])
        want = back @ ((weight * met.along)[:, None] * met.normal)
        want += settings.pull * aim.matrix.T @ missing
        step = _follow(plate, refine, back, weight, met.normal, want)
        places, missing = places + refine @ step, missing - aim.matrix @ step
    normals = vertex_normals(places, template.refined_triangles)
    met = _look(places, template, surface, settings.last.reach)
    height = _level(places, template, met, settings.last.stiffness)
    return Projected(places + height[:, None] * normals, met.found)


@dataclass(frozen=True, slots=True)
class _Met:
    found: Flags
    """(W,)"""
    height: Array
    """(W,) mm along the vertex's own normal; 0 where nothing was found."""
    normal: Array
    """(W, 3) of the scan there; of the vertex where nothing was found."""
    along: Array
    """(W,) mm along that normal."""


def _look(places: Array, template: Template, surface: Surface, reach: float) -> _Met:
    """What each vertex sees of the scan before and behind it, the nearer of the two."""
    normals = vertex_normals(places, template.refined_triangles)
    height = np.full(len(places), np.inf)
    met_normal = normals.copy()
    for sign in (1.0, -1.0):
        hits = surface.hits(places, sign * normals, reach)
        facing = surface.normals[hits.triangle]
        good = hits.met & template.outside & (hits.distance < np.abs(height))
        good &= np.einsum("vx,vx->v", facing, normals) > _FACING
        height[good] = sign * hits.distance[good]
        met_normal[good] = facing[good]
    found = np.isfinite(height)
    height = np.where(found, height, 0.0)
    return _Met(found, height, met_normal, height * np.einsum("vx,vx->v", normals, met_normal))


def _follow(
    plate: sparse.spmatrix,
    refine: sparse.csr_matrix,
    back: sparse.csr_matrix,
    weight: Array,
    normal: Array,
    want: Array,
) -> Array:
    """(V, 3) the motion of the control mesh.

    The scan couples x, y and z; a solver that holds each vertex alike in all directions does not,
    and makes the conjugate gradients converge in tens of steps.
    """
    count = refine.shape[1]

    def energy(flat: Array) -> Array:
        motion = flat.reshape(count, 3)
        pressed = weight * np.einsum("wx,wx->w", refine @ motion, normal)
        return np.asarray(plate @ motion + back @ (pressed[:, None] * normal)).ravel()

    alike = factor(plate + back @ sparse.diags(weight / 3.0) @ refine)
    size = 3 * count
    solution, _ = cg(
        LinearOperator((size, size), energy),
        want.ravel(),
        rtol=_TOLERANCE,
        maxiter=_MOST_STEPS,
        M=LinearOperator((size, size), lambda r: alike.solve(r.reshape(count, 3)).ravel()),
    )
    return np.asarray(solution.reshape(count, 3))


def _level(places: Array, template: Template, met: _Met, stiffness: float) -> Array:
    """(W,) mm each refined vertex still goes along its own normal. What met nothing keeps to the
    plate's place but for a seam."""
    weight = np.where(met.found, 1.0, _SEAM)
    matrix = sparse.diags(weight) + stiffness * bending(places, template.refined_triangles)
    height, _ = cg(
        matrix.tocsr(),
        weight * met.height,
        rtol=_TOLERANCE,
        maxiter=_MOST_STEPS,
        M=sparse.diags(1.0 / matrix.diagonal()),
    )
    return np.asarray(height)


_AXIS_BEHIND = 70.0
"""mm the axis of the cylinder runs behind the face's foremost point, as through a neck."""
_CYLINDER_REACH = 8.0


def around_cylinder(
    start: Array, template: Template, surface: Surface, aim: Aim, settings: Settings
) -> Projected:
    """[Z] §2: each vertex goes to the scan on its way to or from the axis; what finds none within
    8 mm stays. ``start`` must stand upright (+y up). ``aim`` and ``settings`` have no part in
    it."""
    axis = start[:, 2].max() - _AXIS_BEHIND
    radial = (start - [np.median(start[:, 0]), 0.0, axis]) * [1.0, 0.0, 1.0]
    radial /= np.maximum(np.linalg.norm(radial, axis=1, keepdims=True), 1e-9)
    height = np.full(len(start), np.inf)
    for sign in (1.0, -1.0):
        hits = surface.hits(start, sign * radial, _CYLINDER_REACH)
        nearer = hits.met & template.outside & (hits.distance < np.abs(height))
        height[nearer] = sign * hits.distance[nearer]
    found = np.isfinite(height)
    return Projected(start + np.where(found, height, 0.0)[:, None] * radial, found)


PROJECTIONS: dict[str, Projection] = {"normals": along_normals, "cylinder": around_cylinder}
