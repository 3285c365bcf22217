"""Hair in broad forms: a cap over the skull, and locks that lie on it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from mien.numeric.normals import vertex_normals
from mien.sculpt.colour import Colour, linear
from mien.sculpt.solid import Form, fan, outward, sheet, spline, tube

Array = NDArray[np.float64]
Edge = Callable[[Array], Array]
"""Degrees from the crown at which hair ends, by azimuth in degrees (0 in front, left positive)."""
Depth = Callable[[Array, Array], Array]
"""mm of hair by azimuth and by the way from crown (0) to edge (1)."""


class Scalp:
    """The skull as distance from one centre, by direction."""

    def __init__(self, skin: Array, centre: ArrayLike = (0, 42, -42)) -> None:
        self.centre = np.asarray(centre, dtype=float)
        ray = skin - self.centre
        self._distance = np.linalg.norm(ray, axis=1)
        self._tree = cKDTree(ray / self._distance[:, None])

    def at(self, direction: Array, above: ArrayLike = 0.0) -> Array:
        """(N, 3) points ``above`` the scalp along unit ``direction`` (N, 3)."""
        apart, near = self._tree.query(direction, k=8)
        weight = 1 / (apart + 0.03) ** 2
        radius = (self._distance[near] * weight).sum(axis=-1) / weight.sum(axis=-1)
        return np.asarray(self.centre + direction * (radius + np.asarray(above))[..., None])

    def polar(self, yaw: ArrayLike, pitch: ArrayLike, above: ArrayLike = 0.0) -> Array:
        """(N, 3) points by degrees of yaw (0 in front, left positive) and pitch (up positive)."""
        y, p = np.radians(yaw), np.radians(pitch)
        direction = np.stack([np.sin(y) * np.cos(p), np.sin(p), np.cos(y) * np.cos(p)], axis=-1)
        return self.at(direction, above)


def cap(
    scalp: Scalp,
    edge: Edge,
    depth: Depth,
    *,
    ridge: float = 0.0,
    ridges: int = 20,
    swirl: float = 0.0,
    zigzag: float = 0.0,
    teeth: int = 18,
    around: int = 72,
    rows: int = 20,
    sink: float = 3.0,
) -> tuple[Form, Array]:
    """Hair as a shell from the crown to its edge, which sinks into the skin; and how high each
    vertex lies on a ridge, 0 to 1. ``zigzag`` degrees of points run along the edge."""
    crown = np.array([0, 0.86, -0.5])
    crown /= np.linalg.norm(crown)
    front = np.array([0, 0, 1.0]) - crown * crown[2]
    front /= np.linalg.norm(front)
    left = np.cross(crown, front)
    azimuth = np.linspace(-np.pi, np.pi, around, endpoint=False)
    along = np.linspace(0, 1, rows)[1:, None]
    saw = np.abs(((azimuth / np.pi * 0.5 * teeth) % 1) - 0.5) * 4 - 1
    polar = along**0.9 * np.radians(edge(np.degrees(azimuth)) + zigzag * saw)[None]
    direction = (
        np.cos(polar)[..., None] * crown
        + (np.sin(polar) * np.cos(azimuth))[..., None] * front
        + (np.sin(polar) * np.sin(azimuth))[..., None] * left
    )
    wave = ridge * np.cos(ridges * (azimuth[None] + swirl * along)) * np.clip(2.5 * along, 0, 1)
    thick = depth(np.degrees(azimuth)[None] + 0 * along, along + 0 * azimuth[None])
    thick = thick + wave * (1 - along**8)
    thick = thick * (1 - 0.92 * np.clip((along - 0.72) / 0.28, 0, 1) ** 2.5)
    thick = np.where(along > 0.985, -sink, thick)
    grid = scalp.at(direction.reshape(-1, 3), thick.ravel())
    top = scalp.at(crown[None], float(depth(np.zeros(1), np.zeros(1))[0]))
    vertices = np.vstack([top, grid])
    triangles = np.concatenate([fan(0, 1, around), sheet(rows - 1, around, 1)])
    height = 0.5 + 0.5 * wave / ridge if ridge else np.full_like(wave, 0.5)
    return outward(vertices, triangles, scalp.centre), np.append(0.5, height.ravel())


def lock(
    scalp: Scalp,
    course: Sequence[tuple[float, float, float]],
    width: float,
    height: float,
    *,
    rows: int = 14,
    around: int = 8,
    start: float = 0.55,
    end: float = 0.03,
    widest: float = 0.45,
) -> Form:
    """One lock along a ``course`` of (yaw, pitch, mm above the scalp), thin at root and tip."""
    yaw, pitch, above = np.array(course, dtype=float).T
    path = spline(scalp.polar(yaw, pitch, above), rows)
    up = path - scalp.centre
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    along = np.linspace(0, 1, rows)
    rise = start + (1 - start) * np.sin(along / widest * np.pi / 2)
    fall = np.clip(np.cos((along - widest) / (1 - widest) * np.pi / 2), 0, 1) ** 0.8
    profile = np.where(along < widest, rise, end + (1 - end) * fall)
    return tube(path, width * profile, height * profile, up, around)


def shaded(form: Form, dark: Colour, light: Colour, ridge: Array | None = None) -> Array:
    """(V, 3) hair colour: light where it looks up and where it rides high."""
    amount = np.clip(0.35 + 0.65 * vertex_normals(form[0], form[1].astype(np.int32))[:, 1], 0, 1)
    if ridge is not None:
        amount = 0.5 * amount + 0.5 * ridge
    return np.asarray(linear(dark) * (1 - amount)[:, None] + linear(light) * amount[:, None])


def curve(*knots: tuple[float, float]) -> Edge:
    """Degrees by |azimuth|, straight between ``knots`` of (azimuth, degrees)."""
    at, value = np.array(knots, dtype=float).T
    return lambda azimuth: np.interp(np.abs(azimuth), at, value)
