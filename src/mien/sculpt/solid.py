"""A named piece of a sculpture, and the plain forms pieces are made of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import CubicSpline

from mien.numeric.normals import vertex_normals

Array = NDArray[np.float64]
Index = NDArray[np.intp]
Form = tuple[Array, Index]
"""Vertices (V, 3) and triangles (T, 3), counter-clockwise seen from outside."""


@dataclass(frozen=True, slots=True)
class Solid:
    """One part of a character, in the sculpting frame."""

    name: str
    material: str
    vertices: Array
    triangles: Index
    colours: Array
    """(V, 3) or (3,) linear RGB."""
    follows: str = "head"
    shade: float = 1.0
    """How much of the baked occlusion shows."""
    revealed: bool = False
    """Occlusion is baked with the mouth open: shut, all inside it would be black."""

    def mirrored(self) -> Solid:
        """The right one of this left one."""
        return replace(
            self,
            name=self.name.replace("_left", "_right"),
            follows=self.follows.replace("_left", "_right"),
            vertices=self.vertices * [-1, 1, 1],
            triangles=self.triangles[:, ::-1],
        )


def outward(vertices: Array, triangles: Index, middle: ArrayLike) -> Form:
    """The form with its triangles turned to face away from ``middle`` (3,) or (V, 3)."""
    facing = (
        (vertices - np.asarray(middle)) * vertex_normals(vertices, triangles.astype(np.int32))
    ).sum()
    return vertices, triangles if facing >= 0 else triangles[:, ::-1]


def merged(forms: Sequence[Form]) -> Form:
    """Several forms as one."""
    starts = np.cumsum([0] + [len(vertices) for vertices, _ in forms])
    triangles = [triangles + start for (_, triangles), start in zip(forms, starts, strict=False)]
    return np.concatenate([vertices for vertices, _ in forms]), np.concatenate(triangles)


def sheet(rows: int, columns: int, first: int = 0, closed: bool = True) -> Index:
    """Triangles of a grid of vertices, row after row; ``closed`` joins last column and first."""
    here = np.arange(columns if closed else columns - 1)
    there = (here + 1) % columns
    strips = [np.empty((0, 3), dtype=np.intp)]
    for row in range(rows - 1):
        low, high = first + row * columns, first + (row + 1) * columns
        strips.append(np.stack([low + here, high + here, low + there], axis=1))
        strips.append(np.stack([low + there, high + here, high + there], axis=1))
    return np.concatenate(strips)


def fan(pole: int, first: int, columns: int) -> Index:
    """Triangles from one vertex to a closed ring that starts at ``first``."""
    here = np.arange(columns)
    return np.stack([np.full(columns, pole), first + here, first + (here + 1) % columns], axis=1)


def dome(pole: ArrayLike, rings: Array) -> Form:
    """A pole and rings (R, C, 3) round it. Seen from the pole's side, rings run
    counter-clockwise."""
    rows, columns = rings.shape[:2]
    vertices = np.concatenate([np.reshape(pole, (1, 3)), rings.reshape(-1, 3)])
    return vertices, np.concatenate([fan(0, 1, columns), sheet(rows, columns, 1)])


def ball(centre: ArrayLike, radii: ArrayLike, around: int = 16) -> Form:
    """An ellipsoid."""
    polar = np.linspace(0, np.pi, around // 2 + 1)[1:-1, None]
    angle = np.linspace(0, 2 * np.pi, around, endpoint=False)[None]
    rings = np.stack(
        [np.sin(polar) * np.cos(angle), np.sin(polar) * np.sin(angle), np.cos(polar) + 0 * angle],
        axis=-1,
    )
    vertices, triangles = dome((0, 0, 1), rings)
    last = len(vertices) - around
    triangles = np.concatenate([triangles, fan(len(vertices), last, around)[:, ::-1]])
    vertices = np.vstack([vertices, [0, 0, -1]])
    return vertices * np.broadcast_to(np.asarray(radii, float), (3,)) + centre, triangles


def spline(points: ArrayLike, count: int) -> Array:
    """(count, 3) a smooth curve through ``points``, even in arc length."""
    places = np.asarray(points, dtype=float)
    along = np.append(0, np.cumsum(np.linalg.norm(np.diff(places, axis=0), axis=1)))
    return np.asarray(CubicSpline(along, places)(np.linspace(0, along[-1], count)))


def tube(path: Array, width: ArrayLike, height: ArrayLike, up: ArrayLike, around: int = 8) -> Form:
    """A flattened tube along ``path`` (K, 3), half-axes ``width`` and ``height`` (K,), the height
    towards ``up`` (K, 3); closed at both ends."""
    count = len(path)
    wide, high = np.broadcast_to(width, count), np.broadcast_to(height, count)
    ahead = np.gradient(path, axis=0)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True) + 1e-9
    upward = np.broadcast_to(np.asarray(up, dtype=float), (count, 3))
    upward = upward - (upward * ahead).sum(axis=1)[:, None] * ahead
    upward /= np.linalg.norm(upward, axis=1, keepdims=True) + 1e-9
    across = np.cross(ahead, upward)
    angle = np.linspace(0, 2 * np.pi, around, endpoint=False)
    rings = (
        path[:, None]
        + np.cos(angle)[None, :, None] * (across * wide[:, None])[:, None]
        + np.sin(angle)[None, :, None] * (upward * high[:, None])[:, None]
    )
    vertices = np.vstack([rings.reshape(-1, 3), path[0], path[-1]])
    start, end = len(vertices) - 2, len(vertices) - 1
    triangles = np.concatenate(
        [
            sheet(count, around)[:, ::-1],
            fan(start, 0, around)[:, ::-1],
            fan(end, (count - 1) * around, around),
        ]
    )
    return outward(vertices, triangles, np.vstack([np.repeat(path, around, axis=0), path[[0, -1]]]))


def rounded_box(middle: Array, axes: Array, half: ArrayLike, grain: int = 4) -> Form:
    """A superellipsoid box: ``axes`` (3, 3) rows, ``half`` sizes along them."""
    power = 3.2
    line = np.linspace(-1, 1, grain)
    first, second = (side.ravel() for side in np.meshgrid(line, line, indexing="ij"))
    faces = []
    for axis in range(3):
        for sign in (-1.0, 1.0):
            face = np.empty((grain * grain, 3))
            others = [i for i in range(3) if i != axis]
            face[:, axis], face[:, others[0]], face[:, others[1]] = sign, first, second
            faces.append(face)
    corners = np.concatenate(faces)
    corners /= (np.abs(corners) ** power).sum(axis=1, keepdims=True) ** (1 / power)
    one = sheet(grain, grain, closed=False)
    triangles = np.concatenate([one + grain * grain * face for face in range(6)])
    _, keep, row = np.unique(np.round(corners, 5), axis=0, return_index=True, return_inverse=True)
    corners, triangles = corners[keep], row.ravel()[triangles]
    face_normal = np.cross(
        corners[triangles[:, 1]] - corners[triangles[:, 0]],
        corners[triangles[:, 2]] - corners[triangles[:, 0]],
    )
    inward = (face_normal * corners[triangles].mean(axis=1)).sum(axis=1) < 0
    if np.linalg.det(axes) < 0:
        inward = ~inward
    triangles[inward] = triangles[inward][:, ::-1]
    return middle + (corners * np.asarray(half)) @ axes, triangles
