"""How far an eye is open, as seen from the middle of the eye.

Every direction from an eyeball's centre either meets skin or goes out between the lids: what goes
out is the opening, whatever the topology of the mesh about it. A picture in azimuth and elevation
holds it: columns are azimuths, and in each the opening runs from the lower lid's edge to the
upper's.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import label

from mien.face.face import Array, Face, Ints
from mien.numeric.raster import rasterize
from mien.view.camera import look_axes

Mask = NDArray[np.bool_]

_LIDS = {
    "eye_left": ("3.1", "3.3", "3.7", "3.11"),
    "eye_right": ("3.2", "3.4", "3.8", "3.12"),
}
REACH = np.radians(80.0)
"""How far to every side of straight ahead it is looked."""
CELLS = 160
_AIMS = 2
STEP = 2.0 * REACH / CELLS


@dataclass(frozen=True, slots=True)
class Eye:
    """An eye's middle and axes, and what lies about it."""

    centre: Array
    """(3,)"""
    axes: Array
    """(3, 3) rows: across, up, ahead."""

    def polar(self, places: Array) -> tuple[Array, Array, Array]:
        """Azimuth, elevation (radians) and distance (mm) of ``places`` (..., 3)."""
        away = (places - self.centre) @ self.axes.T
        flat = np.hypot(away[..., 0], away[..., 2])
        azimuth = np.arctan2(away[..., 0], away[..., 2])
        return azimuth, np.arctan2(away[..., 1], flat), np.hypot(flat, away[..., 1])

    def place(self, azimuth: Array, elevation: Array, distance: Array) -> Array:
        """The inverse of ``polar``."""
        flat = distance * np.cos(elevation)
        away = np.stack(
            [flat * np.sin(azimuth), distance * np.sin(elevation), flat * np.cos(azimuth)], axis=-1
        )
        return np.asarray(self.centre + away @ self.axes)


def eye_of(face: Face, name: str) -> Eye:
    """The eye ``name`` ("eye_left", "eye_right"), which looks through the middle of its lids."""
    centre = face.pivots[name]
    lids = [fdp for fdp in _LIDS[name] if fdp in face.points.ids]
    ahead = np.array([0.0, 0.0, 1.0])
    if lids:
        through = face.points.at(face.vertices)[face.points.index(lids)].mean(axis=0) - centre
        ahead = through / max(float(np.linalg.norm(through)), 1e-9)
    # An eye that is said to look up or down does so by its lids, not by its socket.
    ahead = np.array([ahead[0], 0.0, ahead[2]])
    return Eye(centre, look_axes(ahead))


def aimed(eye: Eye, vertices: Array, triangles: Ints) -> Eye:
    """``eye`` turned to look through the middle of its opening: eyes of many animals look aside,
    and a gap at the picture's rim could not be told from none."""
    for _ in range(_AIMS):
        free = _most_in_the_middle(~_covered(eye, vertices, triangles))
        if not free.any():
            return eye
        aside = float(np.average(azimuths(), weights=free.sum(axis=0)))
        eye = Eye(eye.centre, look_axes(np.sin(aside) * eye.axes[0] + np.cos(aside) * eye.axes[2]))
    return eye


def ball_radius(eye: Eye, face: Face, name: str) -> Array:
    """(CELLS, CELLS) mm from the middle of the eye to the eyeball's surface in every direction,
    rows from the lowest elevation up; 0 where there is none."""
    runs = [part for part in face.parts if part.follows == name and len(part.triangles)]
    if not runs:
        return np.zeros((CELLS, CELLS))
    triangles = np.concatenate([part.triangles for part in runs])
    screen, ahead = _screen(eye, face.vertices, triangles)
    ids, distance = rasterize(
        screen, triangles[ahead], np.ones(int(ahead.sum()), dtype=bool), CELLS, CELLS
    )
    return np.asarray(np.where(ids >= 0, distance, 0.0), dtype=float)


@dataclass(frozen=True, slots=True)
class Opening:
    """The gap between the lids."""

    gap: Mask
    """(CELLS, CELLS) rows from the lowest elevation up, columns from the least azimuth."""
    upper: Array
    """(CELLS,) elevation of the upper lid's edge at each azimuth; NaN where there is no gap."""
    lower: Array
    """(CELLS,)"""

    @property
    def area(self) -> float:
        """Cells."""
        return float(self.gap.sum())


def azimuths() -> Array:
    """(CELLS,) of the columns' middles."""
    return np.asarray((np.arange(CELLS) + 0.5) * STEP - REACH)


def see(eye: Eye, vertices: Array, triangles: Ints) -> Opening:
    """The opening of ``eye`` among a skin's ``vertices`` (V, 3) and ``triangles`` (T, 3)."""
    covered = _covered(eye, vertices, triangles)
    free = _most_in_the_middle(~covered)
    if free[0].any() or free[-1].any() or free[:, 0].any() or free[:, -1].any():
        # A gap that runs out of the picture has no lids about it.
        free = np.zeros_like(free)
    any_gap = free.any(axis=0)
    rows = np.arange(CELLS)
    lower = np.where(any_gap, np.argmax(free, axis=0) * STEP - REACH, np.nan)
    top = np.where(free, rows[:, None] + 1, 0).max(axis=0)
    upper = np.where(any_gap, top * STEP - REACH, np.nan)
    return Opening(free, upper, lower)


def _covered(eye: Eye, vertices: Array, triangles: Ints) -> Mask:
    screen, ahead = _screen(eye, vertices, triangles)
    two_sided = np.ones(int(ahead.sum()), dtype=bool)
    ids, _ = rasterize(screen, triangles[ahead], two_sided, CELLS, CELLS)
    return np.asarray(ids >= 0)


def _screen(eye: Eye, vertices: Array, triangles: Ints) -> tuple[NDArray[np.float32], Mask]:
    """(V, 3) places in the picture with their distance, and which triangles (T,) lie ahead: the
    picture is cut open behind the eye."""
    azimuth, elevation, distance = eye.polar(vertices)
    screen = np.stack([(azimuth + REACH) / STEP, (elevation + REACH) / STEP, distance], axis=-1)
    ahead = (np.abs(azimuth) < np.pi / 2)[triangles].all(axis=1)
    return screen.astype(np.float32), np.asarray(ahead)


def _most_in_the_middle(free: Mask) -> Mask:
    """The connected part of ``free`` that holds most of the middle of the picture; none where
    nothing there is free."""
    number, count = label(free)
    third = CELLS // 3
    sizes = np.bincount(number[third:-third, third:-third].ravel(), minlength=count + 1)
    sizes[0] = 0
    best = int(sizes.argmax())
    return np.asarray(number == best) if sizes[best] else np.zeros_like(free)
