"""Silhouette: the outline of a turned face lies on an edge of the picture ([C] section 3).

Where the skin turns away from the camera before the background, the picture is searched across the
outline. A place of the outline is drawn towards the edge across it and may slide along:

    r = n . (u(Y) - e) / sigma        n the outline's normal in the picture, e the edge
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.tracker.chart import read
from mien.capture.tracker.crop import Crop
from mien.capture.tracker.person import Person
from mien.capture.tracker.state import Lens, Sites, State
from mien.numeric.gauss_newton import Linearized, tukey
from mien.numeric.raster import NOTHING, rasterize

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
Floats = NDArray[np.float32]
Ints = NDArray[np.int32]

LOSS = tukey(4.0)
"""Hair, collars and what stands behind have edges of their own."""
_REACH, _STEP = 6.0, 0.5
"""mm searched to either side of the outline, and between places that are read."""
_FAINT = 4.0
"""Grey levels a mm: an edge that is fainter is none."""
_BACKGROUND = 4.0
"""mm beyond the outline at which no skin may lie, or it is no silhouette."""


@dataclass(frozen=True, slots=True)
class Folds:
    """The edges between two triangles of a mesh."""

    ends: Ints
    """(E, 2) vertices."""
    sides: Ints
    """(E, 2) triangles."""


def folds(triangles: Ints) -> Folds:
    """Every edge that two of ``triangles`` (T, 3) share."""
    ends = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    side = np.tile(np.arange(len(triangles), dtype=np.int32), 3)
    ends = np.sort(ends, axis=1)
    order = np.lexsort((ends[:, 1], ends[:, 0]))
    twice = np.flatnonzero((ends[order[1:]] == ends[order[:-1]]).all(axis=1))
    first, second = order[twice], order[twice + 1]
    return Folds(ends[first], np.stack([side[first], side[second]], axis=1))


@dataclass(frozen=True, slots=True)
class SilhouetteTerm:
    """N places of the outline and the edges found across it."""

    sites: Sites
    lens: Lens
    normals: Array
    """(N, 2) of length 1, in the picture."""
    edges: Array
    """(N, 2) pixels of the crop."""
    sigma: float
    """Pixels of the crop."""
    weight: float

    def linearize(self, state: State) -> Linearized:
        """(N,) residuals."""
        places = self.sites.seen(state)
        off = self.lens.project(places) - self.edges
        slope = self.lens.pull_back(self.normals / self.sigma, places)
        jacobian = self.sites.chain(slope, places, state)
        residual = (off * self.normals).sum(axis=1) / self.sigma
        return Linearized(residual, jacobian, LOSS, self.weight)

    def pairs(self, state: State) -> Array:
        """(N, 2, 2) pixels of the crop: places of the outline, and the edges across it."""
        return np.stack([self.lens.project(self.sites.seen(state)), self.edges], axis=1)


def match(
    person: Person,
    folds: Folds,
    crop: Crop,
    picture: Floats,
    state: State,
    sigma: float,
    weight: float,
) -> SilhouetteTerm:
    """The outline of ``person`` in ``state`` and the edges of ``picture``, a blurred crop, across
    it; ``sigma`` in mm."""
    lens, space = person.lens(crop), person.space
    shape = person.neutral + np.tensordot(state.weights, space.expression, axes=1)
    vertices = shape @ state.rotation.T + state.translation
    ends, normals = outline(folds, vertices, space.triangles, lens, crop.size)
    middle = lens.project(vertices[ends].mean(axis=1))
    millimetre = lens.scale * lens.focal / float(state.translation[2])
    edges, found = edges_across(picture, middle, normals, millimetre)
    ends = ends[found]
    sites = Sites(person.neutral[ends].mean(axis=1), space.expression[:, ends].mean(axis=2))
    return SilhouetteTerm(sites, lens, normals[found], edges[found], sigma * millimetre, weight)


def outline(
    folds: Folds, vertices: Array, triangles: Ints, lens: Lens, size: tuple[int, int]
) -> tuple[Ints, Array]:
    """The folds (N, 2), by their vertices, at which the skin turns away before the background, and
    their outward normals (N, 2) in the picture. ``vertices`` (V, 3) are in the camera frame,
    ``size`` is that of the crop."""
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    shown = (np.cross(b - a, c - a) * a).sum(axis=1) < 0.0
    turn = shown[folds.sides[:, 0]] != shown[folds.sides[:, 1]]
    ends, sides = folds.ends[turn], folds.sides[turn]
    pixels = lens.project(vertices)
    along = pixels[ends[:, 1]] - pixels[ends[:, 0]]
    length = np.linalg.norm(along, axis=1, keepdims=True)
    normals = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.maximum(length, 1e-9)
    middle = pixels[ends].mean(axis=1)
    inner = np.where(shown[sides[:, 0]], sides[:, 0], sides[:, 1])
    inward = pixels[triangles[inner]].mean(axis=1) - middle
    normals *= -np.sign((normals * inward).sum(axis=1, keepdims=True))
    screen = np.column_stack([pixels, 1000.0 / vertices[:, 2]]).astype(np.float32)
    width, height = size
    ids, _ = rasterize(screen, triangles, np.zeros(len(triangles), dtype=bool), width, height)
    millimetre = lens.scale * lens.focal / vertices[:, 2].mean()
    beyond = np.floor(middle + _BACKGROUND * millimetre * normals).astype(int)
    inside = ((beyond >= 0) & (beyond < (width, height))).all(axis=1)
    column, row = np.clip(beyond.T, 0, [[width - 1], [height - 1]])
    free = inside & ~_filled(ids != NOTHING)[row, column] & (length[:, 0] > 1e-6)
    return ends[free], normals[free]


def _filled(skin: Bools) -> Bools:
    """``skin`` (H, W) without the holes of eyes and mouth."""
    whole = skin.astype(np.uint8)
    rims, _ = cv2.findContours(whole, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    cv2.drawContours(whole, rims, -1, 1, cv2.FILLED)
    return np.asarray(whole, dtype=bool)


def edges_across(
    picture: Floats, middle: Array, normals: Array, millimetre: float
) -> tuple[Array, Bools]:
    """The strongest edge of ``picture`` across an outline at ``middle`` (N, 2) along ``normals``
    (N, 2), rather near than far: its place (N, 2), and whether there is one (N,)."""
    away = np.arange(-_REACH, _REACH + _STEP, _STEP)
    places = middle[:, None] + away[None, :, None] * (millimetre * normals)[:, None]
    grey = read(picture, places.reshape(-1, 2)).reshape(len(middle), len(away)).astype(float)
    steep = np.abs(grey[:, 2:] - grey[:, :-2]) / (2.0 * _STEP)
    likely = steep * np.exp(-0.5 * (away[1:-1] / (0.5 * _REACH)) ** 2)
    best = np.argmax(likely, axis=1)
    rows = np.arange(len(middle))
    inner = (best > 0) & (best < likely.shape[1] - 1)
    around = [steep[rows, np.clip(best + d, 0, steep.shape[1] - 1)] for d in (-1, 0, 1)]
    bend = around[0] - 2.0 * around[1] + around[2]
    shift = np.where(bend < -1e-9, 0.5 * (around[0] - around[2]) / np.minimum(bend, -1e-9), 0.0)
    offset = away[1:-1][best] + _STEP * np.clip(shift, -0.5, 0.5)
    return middle + (offset * millimetre)[:, None] * normals, inner & (around[1] > _FAINT)
