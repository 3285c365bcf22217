"""The mouth of a face, as FAPs need it: which lip, which edge, and what hangs behind.

Lips that are shut lie on each other, and their points lie closer together than a map can tell
apart without swinging. So all points at one place along the mouth share one map, on a skin whose
lips are sewn together, and share it out by lip and by edge: what both lips do keeps them shut.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from mien.face.face import Array, Face, Part
from mien.face.influence import LIPS, Index, Mask, along_the_skin, opening

OUTER_LIPS = ("8.3", "8.5", "8.1", "8.6", "8.4", "8.8", "8.2", "8.7")
"""The outer edge of the lips, once round, beside LIPS."""
LEFT_CORNER, RIGHT_CORNER = ("2.4", "8.3"), ("2.5", "8.4")
PLACES = (
    LEFT_CORNER,
    RIGHT_CORNER,
    ("2.2", "8.1", "2.3", "8.2"),
    ("2.6", "8.5", "2.8", "8.7"),
    ("2.7", "8.6", "2.9", "8.8"),
)
"""Points at the same place along the mouth."""
_UPPER = {"2.2", "2.6", "2.7", "8.1", "8.5", "8.6"}
_STEEP = 4.0
"""How fast one lip passes into the other round the corners of the mouth."""
_RIM_REACH = 16.0
"""mm into the mouth over which its lining no longer follows the lips, on a face of usual size."""
_NEAREST = 4


@dataclass(frozen=True, slots=True)
class Mouth:
    """The lips and the lining of the mouth behind them."""

    above: Index
    below: Index
    """Vertices of the inner edge of the upper and the lower lip, from corner to corner."""
    inside: Mask
    """(V,) behind the inner edge."""
    lower: Array
    """(V,) 0 on the side of the upper lip, 1 on that of the lower, as the skin runs."""
    outer: Array
    """(V,) 0 on the inner edge of the lips and inside, 1 on their outer edge and beyond."""

    def share(self, fdp: str, moved: Sequence[str]) -> Array:
        """(V,) part of its place's map that belongs to one point, where FAPs move ``moved``."""
        share = np.ones(len(self.lower))
        if fdp not in (*LEFT_CORNER, *RIGHT_CORNER):
            share = 1.0 - self.lower if fdp in _UPPER else self.lower
        if _other_edge(fdp) in moved:
            share = share * (self.outer if fdp in OUTER_LIPS else 1.0 - self.outer)
        return share

    def sewn(self, face: Face) -> sparse.csr_matrix:
        """(N, V): what is zero where the edges of both lips do the same."""
        near, weight = _nearest(face, self.below, self.above)
        rows = np.arange(len(self.above))
        one = sparse.csr_matrix((np.ones(len(rows)), (rows, self.above)), self._shape(rows))
        other = sparse.csr_matrix(
            (weight.ravel(), (np.repeat(rows, _NEAREST), near.ravel())), self._shape(rows)
        )
        return (one - other).tocsr()

    def _shape(self, rows: Index) -> tuple[int, int]:
        return len(rows), len(self.lower)


def mouth(face: Face, skin: Part) -> Mouth:
    """The mouth in the ``skin`` of ``face``. Raises KeyError for a missing point, InputError where
    the skin is in pieces there."""
    hole, contour = opening(face, skin, LIPS), opening(face, skin, OUTER_LIPS)
    turn = int(np.argmin(np.linalg.norm(face.vertices[hole.rim] - face.point(LIPS[4]), axis=1)))
    above, below = hole.rim[: turn + 1], np.append(hole.rim[turn:], hole.rim[0])
    to_above, to_below = along_the_skin(face, above), along_the_skin(face, below)
    on = np.isfinite(to_above)
    lower = np.zeros(len(face.vertices))
    way = to_above[on] / np.maximum(to_above + to_below, 1e-9)[on]
    lower[on] = np.clip((way - 0.5) * _STEEP + 0.5, 0.0, 1.0)
    inner, _ = cKDTree(face.vertices[hole.rim]).query(face.vertices)
    outer, _ = cKDTree(face.vertices[contour.rim]).query(face.vertices)
    part = inner / np.maximum(inner + outer, 1e-9)
    beyond = ~contour.inside
    across = np.where(beyond, 1.0, part * part * (3.0 - 2.0 * part))
    across[hole.inside] = 0.0
    across[hole.rim] = 0.0
    return Mouth(above, below, hole.inside, lower, across)


def _other_edge(fdp: str) -> str:
    """The point at the same place of the same lip on its other edge."""
    if fdp in OUTER_LIPS:
        return LIPS[OUTER_LIPS.index(fdp)]
    return OUTER_LIPS[LIPS.index(fdp)]


def hang_lining(face: Face, lips: Mouth, lining: Mask, fields: Array, bone: Array) -> None:
    """Let the ``lining`` (V,) of the mouth follow the edges of the lips in front and the jaws
    behind: fills its part of ``fields`` (N, V, 3). ``bone`` (N, V, 3) is what the lower jaw does;
    the upper stays."""
    size = float(np.linalg.norm(face.pivots["eye_left"] - face.pivots["eye_right"])) / 63.0
    depth = np.minimum(along_the_skin(face, lips.above), along_the_skin(face, lips.below))[lining]
    share = np.exp(-((depth / (_RIM_REACH * size)) ** 2))[:, None]
    lower = lips.lower[lining][:, None]
    followed = np.zeros((len(fields), int(lining.sum()), 3))
    for rim, belongs in ((lips.above, 1.0 - lower), (lips.below, lower)):
        near, weight = _nearest(face, rim, np.flatnonzero(lining))
        followed += belongs * np.einsum("nvkx,vk->nvx", fields[:, near], weight)
    fields[:, lining] = share * followed + (1.0 - share) * lower * bone[:, lining]


def _nearest(face: Face, among: Index, to: Index) -> tuple[Index, Array]:
    """Vertices (N, K) of ``among`` that are nearest to each of ``to`` (N,), and weights (N, K)."""
    distance, near = cKDTree(face.vertices[among]).query(face.vertices[to], k=_NEAREST)
    weight = 1.0 / np.maximum(distance, 1e-6) ** 2
    return among[near], weight / weight.sum(axis=1, keepdims=True)
