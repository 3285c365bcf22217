"""Feature points of a scan, found on pictures of it.

The scan is drawn from the front until the detector sees a face. That gives the head's pose, and
the scan is drawn again upright from three sides. Landmarks are lifted along the rays through their
pixels to the surface.

The detector means by a landmark what it means, not what the standard means by a feature point. So
it looks at a reference as well, a face whose feature points are known: the generic face, or a scan
whose points a user has corrected. Eyes and lips have edges that it sees sharply: there it is off by
as much on the scan as on the reference. On brows, cheeks and nose all landmarks together make a
smooth field from reference to scan that carries the points, for one alone wanders.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.errors import InputError, NoFaceError
from mien.face.face import Array, Face
from mien.face.library import generic_face
from mien.face.mesh import Mesh
from mien.formats.meshes.lengths import UNITS
from mien.formats.meshes.scans import AXES as _AXES
from mien.formats.meshes.scans import stand
from mien.numeric import rbf
from mien.numeric.facing import ClosestPoints
from mien.numeric.procrustes import Similarity, align, rigid_part
from mien.scan.parameterise import ScanPoints
from mien.scan.picture import Picture, draw, drawable
from mien.scan.surface import Surface
from mien.view.camera import Camera
from mien.vocabulary.landmarks import FACE_LANDMARKS, feature_points

Detect = Callable[[Picture], NDArray[np.float32] | None]
"""Landmarks (N, 3) of a picture in pixels, or None: the detector, which is not this room's."""

_SIZE, _GLANCE = 640, 320
_FRONTS = ((0.0, 0.0), (0.4, 0.0), (-0.4, 0.0), (0.0, 0.3), (0.0, -0.3), (0.7, 0.0), (-0.7, 0.0))
"""Yaw and pitch from which a face is first looked for."""
_CLOSER = (1.15, 0.75, 0.5)
"""Shares of the scan's height that fill the first picture: heads, heads on necks, busts."""
_VIEWS = (0.0, 0.25, -0.25, 0.5, -0.5)
_FRAME = 250.0
"""mm of the head that fill the later pictures, on a face as large as the generic one."""
_RING = 0.006
"""Of a picture's height: about a ray within which its surface is looked for."""
_FACING = 0.25
"""Least cosine between the skin and a ray that lifts a landmark onto it."""
_ASTRAY = 6.0
"""mm a lifted landmark may lie off the surface that the others suggest; through an open mouth or a
hole one sees something else."""
_STIFF = 0.3
"""Smoothing of that surface."""
_EDGES = ("2.", "3.", "8.")
_CHIN = ("2.1", "2.10")
_FIELD = 0.3
"""Smoothing of the field from reference to scan."""
_STRANGE = 9.0
"""mm by which half of the landmarks may be off the generic face's: people are by 6, what the
detector makes of a face upside down by 12."""
_UPRIGHT = 0.6
"""Least cosine between a head's axes and those of the scan."""
_GIANT, _PUPILS = 1.6, 63.0
_SNAP = 6.0
"""mm within which a point is put onto the scan."""


@dataclass(frozen=True, slots=True)
class Reference:
    """A face whose feature points are known."""

    mesh: Mesh
    points: ScanPoints


def generic_reference() -> Reference:
    """The generic face as a reference."""
    return face_reference(generic_face().face)


def face_reference(face: Face) -> Reference:
    """A face of ours as a reference."""
    mesh = Mesh(face.vertices, face.triangles, face.colours)
    return Reference(mesh, ScanPoints(face.points.ids, face.points.at(face.vertices)))


class PointFinder:
    """Finds feature points on scans as they are on one reference."""

    def __init__(self, detect: Detect, reference: Reference | None = None) -> None:
        """``detect`` finds landmarks on pictures. Raises NoFaceError where it sees no face on the
        reference."""
        reference = reference or generic_reference()
        wanted = feature_points()
        self._detect = detect
        own, pose = _landmarks(reference.mesh, detect)
        self._own = _in_head(pose, own)
        self.ids = [name for name in wanted if name in reference.points.ids]
        self._rows = [wanted[name] for name in self.ids]
        self._known = _in_head(pose, reference.points.of(self.ids))
        self._edge = np.array([name.startswith(_EDGES) and name not in _CHIN for name in self.ids])

    def find(self, mesh: Mesh, unit: float = 1.0) -> ScanPoints:
        """Feature points of ``mesh``, in millimetres, upright (+y up) and looking roughly along
        +z. Points it does not show are left out.

        ``unit``, the millimetres in the file's unit, is for the message where it is wrong. Raises
        NoFaceError where no face is seen, InputError where it lies or has the size of no head.
        """
        try:
            seen, pose = _landmarks(mesh, self._detect)
            strange = _strangeness(_in_head(pose, seen))
        except NoFaceError:
            strange = np.inf
        if strange > _STRANGE:
            raise NoFaceError(_how_it_stands(mesh, self._detect))
        _require_head(pose, unit)
        # In the head's own axes and size the detector errs alike on both.
        head = _in_head(pose, seen)
        both = np.isfinite(head).all(axis=1) & np.isfinite(self._own).all(axis=1)
        field = rbf.fit(self._own[both], (head - self._own)[both], smoothing=_FIELD)
        carried = self._known + field(self._known)
        beside = self._known + (head - self._own)[self._rows]
        places = np.where(self._edge[:, None], beside, carried)
        found = np.isfinite(places).all(axis=1)
        names = tuple(self.ids[row] for row in np.flatnonzero(found))
        there = _on_surface(pose(places[found]), mesh, _SNAP * pose.scale)
        return ScanPoints(names, there, found=True)


def _require_head(pose: Similarity, unit: float) -> None:
    """Raise InputError where a face is there but lies, or has the size of no head."""
    above, ahead = pose.rotation[:, 1], pose.rotation[:, 2]
    if above[1] < _UPRIGHT or ahead[2] < _UPRIGHT:
        raise InputError(
            "the face does not stand upright and look along +z; say how it does, likely "
            f"--up={_axis_along(above)} --front={_axis_along(ahead)}"
        )
    if not 1.0 / _GIANT < pose.scale < _GIANT:
        raise InputError(
            f"its pupils would be {_PUPILS * pose.scale:.3g} mm apart; say --units, likely "
            f"--units {_unit_about(unit / pose.scale)}"
        )


def _strangeness(places: Array) -> float:
    """Median distance of landmarks (468, 3), in the head's axes and size, from the generic ones."""
    apart = np.linalg.norm(places - generic_face().face.vertices[:FACE_LANDMARKS], axis=1)
    return float(np.nanmedian(apart))


def _how_it_stands(mesh: Mesh, detect: Detect) -> str:
    """What to say of a scan in which no face is seen upright: how it stands, if some way shows
    one."""
    ways = {(up, front): _glance(mesh, detect, up, front) for up in _AXES for front in _AXES}
    up, front = min(ways, key=lambda way: ways[way])
    if ways[up, front] > _STRANGE:
        return (
            "no face is seen on it from any side; write its points into a file SCAN.points.toml "
            "beside it"
        )
    return (
        "no face stands upright on it and looks along +z; say how it stands, likely "
        f"--up={up} --front={front}"
    )


def _glance(mesh: Mesh, detect: Detect, up: str, front: str) -> float:
    """Strangeness of the face on one picture of the scan stood so; infinite where there is none."""
    if up[1] == front[1]:
        return np.inf
    surface = Surface(replace(mesh, vertices=mesh.vertices @ stand(up, front).T))
    generic = generic_face().face.vertices[:FACE_LANDMARKS]
    low, high = surface.mesh.vertices.min(axis=0), surface.mesh.vertices.max(axis=0)
    tall = float(high[1] - low[1])
    middle = tuple(((low + high) / 2.0).tolist())
    camera = Camera(0.0, 0.0, 1.15 * tall, middle, (_GLANCE, _GLANCE), 6.0 * tall)
    marks = detect(draw(drawable(surface.mesh), camera))
    if marks is None:
        return np.inf
    places, facing = lift(marks[:FACE_LANDMARKS, :2].astype(float), camera, surface)
    good = facing > _FACING
    if good.sum() < FACE_LANDMARKS // 2:
        return np.inf
    pose = _robust_pose(generic[good], places[good])
    if pose.rotation[1, 1] < _UPRIGHT or pose.rotation[2, 2] < _UPRIGHT:
        return np.inf
    return _strangeness(_in_head(pose, np.where(good[:, None], places, np.nan)))


def _unit_about(millimetres: float) -> str:
    """The unit of a name that is about so long, else the number."""
    for name in ("mm", "cm", "m"):
        if 1.0 / _GIANT < UNITS[name] / millimetres < _GIANT:
            return name
    return f"{millimetres:.3g} (mm in a unit of the file)"


def _axis_along(direction: Array) -> str:
    longest = int(np.argmax(np.abs(direction)))
    return ("+" if direction[longest] > 0 else "-") + "xyz"[longest]


def _on_surface(places: Array, mesh: Mesh, reach: float) -> Array:
    """``places`` (N, 3) moved to the nearest of the mesh, where it is within ``reach``."""
    nearest = ClosestPoints(mesh.vertices, mesh.triangles)(places)
    there = nearest.matrix(mesh.triangles, len(mesh.vertices)) @ mesh.vertices
    return np.where((nearest.distance < reach)[:, None], there, places)


def _in_head(pose: Similarity, places: Array) -> Array:
    return np.asarray((places - pose.shift) @ pose.rotation / pose.scale)


def _landmarks(mesh: Mesh, detect: Detect) -> tuple[Array, Similarity]:
    """Landmarks (468, 3) on the surface, not a number where it does not show them, and the pose
    that takes the generic head frame to the mesh."""
    surface = Surface(mesh)
    generic = generic_face().face.vertices[:FACE_LANDMARKS]
    pose = _first_pose(surface, detect, generic)
    upright = Surface(replace(mesh, vertices=_in_head(pose, mesh.vertices)))
    subject = drawable(upright.mesh)
    total, weight = np.zeros((FACE_LANDMARKS, 3)), np.zeros(FACE_LANDMARKS)
    for yaw in _VIEWS:
        camera = Camera(yaw=yaw, height=_FRAME, centre=(0.0, -20.0, -30.0), size=(_SIZE, _SIZE))
        marks = detect(draw(subject, camera))
        if marks is None:
            continue
        places, facing = lift(marks[:FACE_LANDMARKS, :2].astype(float), camera, upright)
        good = facing > _FACING
        if good.sum() < FACE_LANDMARKS // 3:
            continue
        good &= _agrees(places, good, generic)
        share = np.where(good, facing**2, 0.0)
        total += share[:, None] * np.where(good[:, None], places, 0.0)
        weight += share
    with np.errstate(invalid="ignore"):
        return pose(total / weight[:, None]), pose


def _first_pose(surface: Surface, detect: Detect, generic: Array) -> Similarity:
    subject = drawable(surface.mesh)
    low, high = surface.mesh.vertices.min(axis=0), surface.mesh.vertices.max(axis=0)
    tall = high[1] - low[1]
    for share in _CLOSER:
        # A face is at the top of whatever it is part of.
        centre = (low + high) / 2.0
        centre[1] = high[1] - min(share, 1.0) * tall / 2.0
        for yaw, pitch in _FRONTS:
            camera = Camera(
                yaw, pitch, share * tall, tuple(centre.tolist()), (_SIZE, _SIZE), 6.0 * tall
            )
            marks = detect(draw(subject, camera))
            if marks is None:
                continue
            places, facing = lift(marks[:FACE_LANDMARKS, :2].astype(float), camera, surface)
            good = facing > _FACING
            if good.sum() > FACE_LANDMARKS // 2:
                return _robust_pose(generic[good], places[good])
    raise NoFaceError("no face is seen from the front")


def _robust_pose(generic: Array, places: Array) -> Similarity:
    size = align(generic, places).scale
    turn = rigid_part(size * generic, places, 3.0 * size)
    return Similarity(size, turn.rotation, turn.shift)


def lift(marks: Array, camera: Camera, surface: Surface) -> tuple[Array, Array]:
    """Places (N, 3) of ``surface`` seen at pixels ``marks`` (N, 2), not a number where there is
    none, and the cosine (N,) between its normal and the ray; 0 where there is none.

    What is nearest within a ring about the ray counts: a mark may fall into a hole, or beside
    the edge of a lip.
    """
    eye = np.asarray(camera.centre) + camera.distance * camera.axes()[2]
    ring = _RING * camera.size[1] * _around()
    around = marks[None] + ring[:, None]
    toward = np.concatenate([around, np.ones((*around.shape[:2], 1))], axis=2) @ camera.rays()
    toward /= np.linalg.norm(toward, axis=2, keepdims=True)
    hits = surface.hits(np.broadcast_to(eye, toward.shape).reshape(-1, 3), -toward.reshape(-1, 3))
    distance = hits.distance.reshape(around.shape[:2])
    first = distance.min(axis=0)
    near = distance < first + 2.0 * _RING * camera.height
    normals = np.einsum("rnx,rn->nx", surface.normals[hits.triangle].reshape(toward.shape), near)
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-9)
    with np.errstate(invalid="ignore"):
        depth = np.where(near, distance, 0.0).sum(axis=0) / near.sum(axis=0)
        places = eye - depth[:, None] * toward[0]
    facing = np.einsum("nx,nx->n", normals, toward[0])
    return places, np.where(np.isfinite(first), facing, 0.0)


def _around() -> Array:
    """(9, 2) the middle and eight directions."""
    turn = np.arange(8) * np.pi / 4.0
    return np.vstack([[0.0, 0.0], np.stack([np.cos(turn), np.sin(turn)], axis=1)])


def _agrees(places: Array, good: NDArray[np.bool_], generic: Array) -> NDArray[np.bool_]:
    """(N,) whether each place lies near the surface that all of them suggest."""
    rows = np.flatnonzero(good)
    for _ in range(3):
        field = rbf.fit(generic[rows], places[rows], smoothing=_STIFF)
        missed = np.linalg.norm(field(generic) - places, axis=1)
        rows = np.flatnonzero(good & (missed < _ASTRAY))
    return np.asarray(good & (missed < _ASTRAY))
