"""Texture coordinates: the skin as one piece of cloth, everything else as it is seen.

Round the silhouette of the face, an ellipse, the skull lies in rings out to the collar. Inside it
every vertex is the mean of its neighbours in mean value coordinates (Floater, Mean Value
Coordinates, 2003), which keeps shapes and, the ellipse being convex, folds nothing over. All of the
cast have the generic face's layout: a texture painted for one fits the others.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import splu

from mien.sculpt.anatomy.cage import Cage, cage
from mien.sculpt.anatomy.head import neutral_head
from mien.sculpt.cast.generic import GENERIC_FACE
from mien.sculpt.solid import Solid
from mien.vocabulary import topology

Array = NDArray[np.float64]

_MARGIN = 0.01
"""Of the picture, left free round every island."""
_CORNER = 0.146
"""Side of the squares that a round picture leaves free."""
_FACE = np.array([0.56, 0.7])
"""Half-axes of the silhouette, of the collar's circle."""


def unwrapped(solids: Sequence[Solid]) -> Array:
    """(V, 2) places in a picture, u to the right and v down from its upper left corner, 0..1.

    Each material has a picture. The skin, which comes first, fills its own but for the corners;
    other parts lie side by side in tiles, and their front and back cover each other.
    """
    skin, *rest = solids
    places = [_skin()]
    for solid in rest:
        sharing = [other.name for other in rest if other.material == solid.material]
        number, count = sharing.index(solid.name), len(sharing)
        flat = _flat(solid.vertices)
        if solid.material != skin.material:
            places.append(_tile(flat, number, count))
            continue
        row, column = divmod(number % 4, 2)
        inner = _tile(flat, number // 4, -(-count // 4))
        places.append(_CORNER * inner + (1.0 - _CORNER) * np.array([column, row]))
    return np.concatenate(places)


@cache
def _skin() -> Array:
    """(fine, 2) the skin, crown above, chin below, the subject's left to the right."""
    mesh = cage()
    loops = np.vstack([topology.SILHOUETTE, mesh.rings])
    turn = np.arange(loops.shape[1]) * 2.0 * np.pi / loops.shape[1]
    circle = np.stack([np.sin(turn), -np.cos(turn)], axis=1)
    outward = np.linspace(0.0, 1.0, len(loops))[:, None, None]
    places = np.zeros((mesh.count, 2))
    places[loops] = circle * ((1.0 - outward) * _FACE + outward)
    inside = np.ones(mesh.count)
    inside[loops] = 0.0
    system = sparse.diags(inside) @ _mean_value(mesh) + sparse.diags(1.0 - inside)
    places = splu(system.tocsc()).solve(places)
    places = 0.5 * (places + places[mesh.mirror] * [-1.0, 1.0])
    fine = np.concatenate([places, places[mesh.subdivision.edges].mean(axis=1)])
    return np.asarray(0.5 + (0.5 - _MARGIN) * fine)


def _mean_value(mesh: Cage) -> sparse.csr_matrix:
    """(count, count) each vertex less the mean of its neighbours, on the generic face."""
    skin = neutral_head(GENERIC_FACE.proportions).skin
    corners = skin[mesh.triangles]
    weights, here, there = [], [], []
    for corner in range(3):
        own, after, before = (np.roll(corners, -corner - step, axis=1)[:, 0] for step in range(3))
        ahead, behind = after - own, before - own
        lengths = np.linalg.norm(ahead, axis=1), np.linalg.norm(behind, axis=1)
        angle = np.arccos(np.clip((ahead * behind).sum(1) / (lengths[0] * lengths[1]), -1.0, 1.0))
        vertex = np.roll(mesh.triangles, -corner, axis=1)
        for neighbour, length in zip((1, 2), lengths, strict=True):
            weights.append(np.tan(angle / 2.0) / length)
            here.append(vertex[:, 0])
            there.append(vertex[:, neighbour])
    entries = (np.concatenate(here), np.concatenate(there))
    near = sparse.csr_matrix((np.concatenate(weights), entries), (mesh.count, mesh.count))
    total = np.maximum(np.asarray(near.sum(axis=1)).ravel(), 1e-12)
    return sparse.identity(mesh.count, format="csr") - sparse.diags(1.0 / total) @ near


def _flat(vertices: Array) -> Array:
    """(N, 2) ``vertices`` seen from where they look largest, in a unit square."""
    centred = vertices - vertices.mean(axis=0)
    _, _, axes = np.linalg.svd(centred, full_matrices=False)
    axes *= np.sign(axes[np.arange(3), np.abs(axes).argmax(axis=1)])[:, None]
    seen = centred @ axes[:2].T * [1.0, -1.0]
    low = seen.min(axis=0)
    return np.asarray((seen - low) / max(float((seen.max(axis=0) - low).max()), 1e-9))


def _tile(flat: Array, number: int, count: int) -> Array:
    """``flat`` shrunk into the tile ``number`` of a square grid that holds ``count``."""
    side = int(np.ceil(np.sqrt(count)))
    row, column = divmod(number, side)
    return np.asarray((np.array([column, row]) + _MARGIN + (1 - 2 * _MARGIN) * flat) / side)
