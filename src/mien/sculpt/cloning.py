"""Expression cloning (Noh and Neumann 2001): one face's motion on another, vertex by vertex.

Where the faces share their mesh, vertex answers to vertex (the trivial case). Where they do not,
the source is laid on the target by its feature points and its shape (``transfer.correspondence``),
in which lips and lids are told apart by the way they face. Each motion vector is turned as the
surface about it was turned in that, and made longer or shorter as the surface was.

People do not always smile by more for having a wider face: motion keeps its length where ``size``
is False. Deformation transfer (``transfer``) is the other way, which matches gradients instead of
vectors and knows contact.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import sparse

from mien.face.face import Array, Face, Ints
from mien.sculpt.transfer.correspondence import correspond
from mien.sculpt.transfer.skin import skin_of

_ROUNDS = 3
"""Neighbourhoods over which the surface's turn and size are taken: a single ring is noise."""


def clone(
    source: Face,
    motions: NDArray[np.floating[Any]],
    target: Face,
    *,
    turn: bool = True,
    size: bool = True,
) -> NDArray[np.float32]:
    """Motions (K, V, 3) mm of ``target``'s vertices, from ``motions`` (K, S, 3) of ``source``'s.

    ``turn`` and ``size``: whether vectors follow the surface's local turn and size. Between
    different meshes only the skin moves. Raises InputError where the faces share too few feature
    points for that.
    """
    if _alike(source, target):
        bent = _bent(source.vertices, target.vertices, source.triangles, turn, size)
        return _apply(bent, motions).astype(np.float32)
    skin, own = skin_of(source), skin_of(target)
    laid = correspond(source, target, skin, own)
    bent = _bent(skin.vertices, laid.warped, skin.triangles, turn, size)
    moved = _apply(bent, np.stack([skin.gather(motion) for motion in motions]))
    answered = np.stack([laid.partner @ motion for motion in moved])
    return own.spread(answered, len(target.vertices)).astype(np.float32)


def _alike(source: Face, target: Face) -> bool:
    return len(source.vertices) == len(target.vertices) and np.array_equal(
        source.triangles, target.triangles
    )


def _apply(bent: Array, motions: NDArray[np.floating[Any]]) -> Array:
    return np.asarray(np.einsum("vxy,kvy->kvx", bent, motions))


def _bent(before: Array, after: Array, triangles: Ints, turn: bool, size: bool) -> Array:
    """(V, 3, 3) turn times size of the surface about each vertex, from ``before`` to ``after``."""
    count = len(before)
    edges = np.unique(
        np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])),
        axis=0,
    )
    old, new = (place[edges[:, 1]] - place[edges[:, 0]] for place in (before, after))
    at = np.concatenate([edges[:, 0], edges[:, 1]]), np.tile(np.arange(len(edges)), 2)
    ring = sparse.csr_matrix((np.ones(2 * len(edges)), at), (count, len(edges)))
    near = (ring @ ring.T > 0).astype(float)
    wide = ring
    for _ in range(_ROUNDS - 1):
        wide = near @ wide
    covariance = wide @ np.einsum("ex,ey->exy", new, old).reshape(-1, 9)
    left, _, right = np.linalg.svd(covariance.reshape(-1, 3, 3))
    left[..., 2] *= np.sign(np.linalg.det(left @ right))[:, None]
    turns = left @ right if turn else np.broadcast_to(np.eye(3), left.shape)
    if not size:
        return np.asarray(turns)
    longer = wide @ (new**2).sum(axis=1) / np.maximum(wide @ (old**2).sum(axis=1), 1e-12)
    return np.asarray(np.sqrt(longer)[:, None, None] * turns)
