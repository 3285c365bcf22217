"""The mean head: the detector's mean landmarks carried on over a skull and down a neck.

The rings lie on a field of three solids (cranium, jaw, neck); the mask keeps the measured places,
and the seam between them is faired.
"""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from mien.sculpt.anatomy.cage import AROUND, LIDS, LIPS, RINGS, cage
from mien.vocabulary import topology

Array = NDArray[np.float64]

_ROUNDS = 4
_CRANIUM = (0.0, 44.0, -39.0)
_NECK_RADIUS, _NECK_FLOOR, _NECK_DEPTH = 55.0, -165.0, -64.0


def mean_landmarks() -> Array:
    """(468, 3) mm: the mean face of several performers; data/mean_landmarks.csv says of whom."""
    path = Path(__file__).parents[1] / "data" / "mean_landmarks.csv"
    rows = [line for line in path.read_text().splitlines() if line[0] not in "#x"]
    return np.array([[float(value) for value in row.split(",")] for row in rows])


@cache
def mean_head() -> Array:
    """(count, 3) the cage laid on the mean face; do not write into it."""
    mesh = cage()
    places = np.zeros((mesh.count, 3))
    places[: topology.LANDMARKS] = mean_landmarks()
    places[mesh.rings] = _skull_rings(places[topology.SILHOUETTE])
    lips = places[LIPS[0]]
    for ring, back in zip(mesh.bag, 6.0 * np.arange(1, 6), strict=True):
        places[ring] = lips - [0, 0, back]
    places[mesh.bag_end] = lips.mean(axis=0) - [0, 0, 45.0]
    for lids, inner in zip(LIDS, mesh.lid_inner, strict=True):
        places[inner] = places[lids[0]] - [0, 0, 4.0]
    return mesh.symmetrised(_faired(places))


def _skull_rings(silhouette: Array) -> Array:
    """(15, 36, 3) rings spread evenly over the skull."""
    angle = np.linspace(0, 2 * np.pi, AROUND, endpoint=False)
    neck = np.stack(
        [
            np.sin(angle) * _NECK_RADIUS,
            np.full(AROUND, _NECK_FLOOR),
            _NECK_DEPTH - np.cos(angle) * _NECK_RADIUS,
        ],
        axis=1,
    )
    along = np.linspace(0, 1, RINGS + 1)[:, None, None]
    above = (np.cos(angle) * 0.5 + 0.5)[None, :, None]
    grid = silhouette * (1 - along) + neck * along
    grid += np.sin(np.pi * along) * above * np.array([0, 150.0, -120.0])
    # Rings that are relaxed any longer shrink: they slide off the crown and down to the neck.
    for _ in range(_ROUNDS):
        sides = np.roll(grid, 1, axis=1) + np.roll(grid, -1, axis=1)
        grid[1:-1] = _onto_skull(0.5 * grid[1:-1] + 0.25 * sides[1:-1])
        grid = _even_columns(grid)
    grid[1:-1] = _onto_skull(grid[1:-1])
    grid[1] = 0.75 * grid[1] + 0.125 * (grid[0] + grid[2])
    return grid[1:]


def _even_columns(grid: Array) -> Array:
    """The columns of ``grid`` (R, C, 3) with their points at even steps."""
    steps = np.linalg.norm(np.diff(grid, axis=0), axis=-1)
    along = np.concatenate([np.zeros((1, grid.shape[1])), np.cumsum(steps, axis=0)])
    even = np.empty_like(grid)
    for column, length in enumerate(along.T):
        wanted = np.linspace(0, length[-1], len(grid))
        for axis in range(3):
            even[:, column, axis] = np.interp(wanted, length, grid[:, column, axis])
    return even


def _faired(places: Array) -> Array:
    """Smooth the seam between mask and skull, holding everything else softly."""
    mesh = cage()
    hold = np.full(mesh.count, 3.0)
    hold[topology.SILHOUETTE] = 0.01
    crown = np.clip(np.cos(np.linspace(0, 2 * np.pi, AROUND, endpoint=False)), 0, 1) ** 0.6
    # The crown columns are held harder than the rest, or the head loses 17 mm of its height.
    for ring, weight in zip(mesh.rings, [0.05, 0.15, 0.4, 1.0] + [3.0] * (RINGS - 4), strict=True):
        hold[ring] = np.maximum(weight, 2.0 * crown)
    hold[mesh.rings[-1]] = 3.0
    beside = np.unique(mesh.laplacian[topology.SILHOUETTE].nonzero()[1])
    beside = beside[beside < topology.LANDMARKS]
    hold[np.setdiff1d(beside, topology.SILHOUETTE)] = 0.25
    anchor = sparse.diags(0.25 * hold)
    system = (mesh.laplacian.T @ mesh.laplacian + anchor).tocsc()
    return np.asarray(splu(system).solve(anchor @ places))


def _onto_skull(places: Array, steps: int = 14) -> Array:
    """Where rays through ``places`` meet the skull: rays from the middle of the cranium above it,
    level rays from the neck's axis below."""
    height = np.minimum(places[..., 1], _CRANIUM[1])
    down = np.clip((height + 30) / -150, 0, 1)
    depth = _CRANIUM[2] - 20 * down
    start = np.stack([0 * height, height, depth], axis=-1)
    ray = places - start
    reach = np.linalg.norm(ray, axis=-1, keepdims=True)
    ray /= reach
    for _ in range(steps):
        reach = reach - _skull(start + reach * ray)[..., None]
    return np.asarray(start + reach * ray)


def _skull(places: Array) -> Array:
    """Signed distance (about) from cranium, jaw and neck, melted into each other."""
    cranium = _ellipsoid(places, _CRANIUM, (76, 85, 98))
    jaw = _ellipsoid(places, (0, -32, -8), (60, 56, 50))
    down = np.clip((places[..., 1] + 30) / -150, 0, 1)
    across = np.hypot(places[..., 0], places[..., 2] + 52 + 12 * down)
    # The neck ends inside the head: an endless one would pierce the crown.
    across = np.hypot(across, np.maximum(places[..., 1] + 30, 0))
    neck = across - (50 + 5 * down**2)
    return _melted(_melted(cranium, jaw, 18.0), neck, 16.0)


def _ellipsoid(
    places: Array, centre: tuple[float, float, float], radii: tuple[float, float, float]
) -> Array:
    scaled = (places - np.array(centre)) / np.array(radii)
    length = np.linalg.norm(scaled, axis=-1)
    slope = np.linalg.norm(scaled / np.array(radii), axis=-1) + 1e-9
    return np.asarray(length * (length - 1) / slope)


def _melted(first: Array, second: Array, width: float) -> Array:
    share = np.clip(0.5 + 0.5 * (second - first) / width, 0, 1)
    return np.asarray(second * (1 - share) + first * share - width * share * (1 - share))
