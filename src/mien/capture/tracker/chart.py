"""A chart of the face: the skin of the narrow face unrolled onto a grid of texels.

A picture is read at the places where a posed face shows its texels, so that a look at rest and a
look in motion lie on one grid: what must be compared is compared texel by texel, and normalised
over the same patches of skin.
"""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.capture.tracker.state import Sites
from mien.face.shape_space import ShapeSpace
from mien.numeric.raster import NOTHING, rasterize

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Bools = NDArray[np.bool_]
Index = NDArray[np.intp]

TEXEL = 2.0
"""mm between texels."""
_AXIS, _RADIUS = -60.0, 100.0
"""z of the upright axis the skin is unrolled about, and mm on the chart of one radian."""


@dataclass(frozen=True, slots=True)
class Chart:
    """M texels on a grid (H, W)."""

    shape: tuple[int, int]
    cell: Index
    """(M,) place of each texel in the grid, row by row."""
    corners: NDArray[np.int32]
    """(M, 3) vertices of the triangle it lies on."""
    shares: Array
    """(M, 3) barycentric."""
    near: Index
    """(M, 4) texels to the left, right, above and below; itself where there is none."""
    inner: Bools
    """(M,) has all four."""

    def __len__(self) -> int:
        return len(self.cell)

    def sites(self, neutral: Array, expression: Array) -> Sites:
        """The texels on a face with ``neutral`` (V, 3) and ``expression`` (K, V, 3)."""
        place = np.einsum("mcx,mc->mx", neutral[self.corners], self.shares)
        moves = np.einsum("kmcx,mc->kmx", expression[:, self.corners], self.shares)
        return Sites(place, moves)

    def grid(self, values: NDArray[np.float32]) -> Floats:
        """(H, W) of ``values`` (M,), 0 where there is no texel."""
        laid = np.zeros(self.shape, dtype=np.float32)
        laid.ravel()[self.cell] = values
        return laid

    def slopes(self, values: Array | Floats, rows: Index) -> tuple[Array, Array]:
        """Differences per texel to the right and down of ``values`` (M, ...) at texels ``rows``."""
        flat = np.ascontiguousarray(values, dtype=float).reshape(len(self), -1)
        right, down = np.empty((2, len(rows), flat.shape[1]))
        _slopes(flat, self.near, rows, right, down)
        shape = (len(rows), *values.shape[1:])
        return right.reshape(shape), down.reshape(shape)


def unroll(space: ShapeSpace) -> Chart:
    """The chart of a space's narrow face."""
    triangles = np.ascontiguousarray(space.triangles[space.narrow], dtype=np.int32)
    x, y, z = space.neutral.T
    flat = np.stack([np.arctan2(x, z - _AXIS) * _RADIUS, -y], axis=1) / TEXEL
    used = flat[np.unique(triangles)]
    flat = flat - used.min(0) + 2.0
    width, height = np.ceil(used.max(0) - used.min(0) + 4.0).astype(int)
    screen = np.column_stack([flat, np.hypot(x, z - _AXIS)])
    ids, _ = rasterize(
        screen.astype(np.float32), triangles, np.zeros(len(triangles), bool), width, height
    )
    rows, columns = np.nonzero(ids != NOTHING)
    corners = triangles[ids[rows, columns]]
    middle = np.stack([columns, rows], axis=1).astype(float) + 0.5
    shares = barycentric(np.asarray(flat[corners], dtype=float), middle)
    number = np.full((height + 2, width + 2), -1, dtype=np.intp)
    number[rows + 1, columns + 1] = np.arange(len(rows))
    near = np.stack(
        [number[rows + 1 + dy, columns + 1 + dx] for dy, dx in ((0, -1), (0, 1), (-1, 0), (1, 0))],
        axis=1,
    )
    inner = np.asarray((near >= 0).all(axis=1))
    near = np.where(near >= 0, near, np.arange(len(rows))[:, None])
    return Chart((height, width), rows * width + columns, corners, shares, near, inner)


def barycentric(triangle: Array, point: Array) -> Array:
    """(M, 3) of ``point`` (M, 2) in ``triangle`` (M, 3, 2)."""
    a, b, c = np.moveaxis(triangle, 1, 0)
    ab, ac, ap = b - a, c - a, point - a
    area = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
    second = (ap[:, 0] * ac[:, 1] - ap[:, 1] * ac[:, 0]) / area
    third = (ab[:, 0] * ap[:, 1] - ab[:, 1] * ap[:, 0]) / area
    return np.stack([1.0 - second - third, second, third], axis=1)


def read(picture: Floats, pixels: Array) -> Floats:
    """(M,) ``picture`` between its pixels at ``pixels`` (M, 2); the first pixel's centre is
    (0.5, 0.5). Beyond the border the border goes on."""
    values = np.empty(len(pixels), dtype=np.float32)
    _read(picture, pixels, values)
    return values


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _read(picture: Floats, pixels: Array, values: Floats) -> None:
    height, width = picture.shape
    for m in range(len(pixels)):
        x = min(max(pixels[m, 0] - 0.5, 0.0), width - 1.001)
        y = min(max(pixels[m, 1] - 0.5, 0.0), height - 1.001)
        column, row = int(x), int(y)
        a, b = np.float32(x - column), np.float32(y - row)
        above = picture[row, column] + a * (picture[row, column + 1] - picture[row, column])
        below = picture[row + 1, column] + a * (
            picture[row + 1, column + 1] - picture[row + 1, column]
        )
        values[m] = above + b * (below - above)


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _slopes(values: Array, near: Index, rows: Index, right: Array, down: Array) -> None:
    for n in range(len(rows)):
        before, after, above, below = near[rows[n]]
        for i in range(values.shape[1]):
            right[n, i] = 0.5 * (values[after, i] - values[before, i])
            down[n, i] = 0.5 * (values[below, i] - values[above, i])


def smoothed(grid: Floats, sigma: float) -> Floats:
    """Gaussian of ``sigma`` cells; nothing beyond the border."""
    return np.asarray(cv2.GaussianBlur(grid, (0, 0), sigma, borderType=cv2.BORDER_CONSTANT))
