"""Lips that meet where the source's do, and never pass through each other.

A closed mouth is a contact, and contacts do not add up from gradients: mouthClose on jawOpen leaves
lips apart by a millimetre or two. So the gap between pairs of points on the inner lips is measured,
and where the source's lips stay shut the target's are brought as near to each other as they were,
half the way each, with the skin about them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import dijkstra

from mien.face.face import Array, Face
from mien.numeric.biharmonic import Handles, spread, uniform_laplacian
from mien.sculpt.transfer.skin import Index, Skin

_PAIRS = (("2.2", "2.3"), ("2.6", "2.8"), ("2.7", "2.9"))
"""Upper and lower inner lip: middle, left and right."""
_SHUT = 2.0
"""mm by which the source's lips may part and still count as shut."""
_ON = {"mouthClose": "jawOpen"}
"""Key models that are judged on another: mouthClose closes what jawOpen opened."""
_AROUND = 0.4
"""Widths of the mouth about the inner lips within which skin goes with them."""
_SLIT = 0.6
"""Part of the way round the nearer corner of the mouth that the way from lip to lip over the skin
is at least, where there is an opening."""
_FIRM, _STIFFNESS = 1e3, 0.01


def meet_lips(
    source: Face,
    skin: Skin,
    motion: Array,
    target: Face,
    own: Skin,
    made: Array,
    names: Sequence[str],
    scale: float,
) -> tuple[Array, tuple[str, ...]]:
    """``made`` (K, N, 3), key models ``names`` of the target's skin ``own``, with its lips as near
    as the source's are by ``motion`` (K, S, 3), which is ``scale`` as long on the target; and what
    could not be done, in plain words."""
    theirs, ours = lips_of(source, skin), lips_of(target, own)
    if theirs is None or ours is None:
        return made, ()
    parts = openings(own, ours)
    if not parts.any():
        return made, ("the mouth has no opening: what parts the lips stretches the skin of it",)
    asked = _on_another(motion, names), _on_another(made, names)
    parted = scale * (theirs.gaps(skin.vertices + asked[0]) - theirs.gaps(skin.vertices[None]))
    rest, now = ours.gaps(own.vertices[None]), ours.gaps(own.vertices + asked[1])
    least = np.minimum(rest, 0.0)
    wanted = np.where(parted < scale * _SHUT, rest + np.minimum(parted, 0.0), now)
    step = parts * (np.maximum(wanted, least) - now)
    carried = _carried(own, ours)
    lift = 0.5 * (step @ carried[: len(step[0])] - step @ carried[len(step[0]) :])
    moved = made.copy()
    moved[..., 1] += lift
    return moved, ()


def _on_another(fields: Array, names: Sequence[str]) -> Array:
    """(K, N, 3) ``fields``, each with the one it is judged on."""
    whole = fields.copy()
    for name, under in _ON.items():
        if name in names and under in names:
            whole[names.index(name)] += fields[names.index(under)]
    return whole


@dataclass(frozen=True, slots=True)
class Lips:
    """Pairs of points on the inner lips of a skin."""

    upper: Index
    """(Q, 3) corners of the triangles they are on."""
    lower: Index
    upper_weights: Array
    """(Q, 3) barycentric."""
    lower_weights: Array
    corners: Array
    """(2, 3) of the mouth."""

    @property
    def width(self) -> float:
        """mm, of the mouth."""
        return float(np.linalg.norm(self.corners[0] - self.corners[1]))

    def nearest(self) -> tuple[Index, Index]:
        """(Q,) and (Q,) the vertices that are nearest to the points."""
        count = np.arange(len(self.upper))
        upper = self.upper[count, self.upper_weights.argmax(axis=1)]
        return upper, self.lower[count, self.lower_weights.argmax(axis=1)]

    def gaps(self, vertices: Array) -> Array:
        """(K, Q) mm from lower to upper lip, upwards, of a skin at ``vertices`` (K, N, 3)."""
        up = vertices[..., 1]
        above = (up[:, self.upper] * self.upper_weights).sum(axis=-1)
        return np.asarray(above - (up[:, self.lower] * self.lower_weights).sum(axis=-1))


def lips_of(face: Face, skin: Skin) -> Lips | None:
    """None where the points are not known, or not on the skin."""
    needed = {*(fdp for pair in _PAIRS for fdp in pair), "8.3", "8.4"}
    if not needed <= set(face.points.ids):
        return None
    rows = [face.points.index([pair[k] for pair in _PAIRS]) for k in (0, 1)]
    corners = [face.points.vertices[row] for row in rows]
    if not np.isin(np.concatenate(corners), skin.rows).all():
        return None
    upper, lower = (skin.welded[np.searchsorted(skin.rows, corner)] for corner in corners)
    weights = [face.points.weights[row] for row in rows]
    ends = np.stack([face.point("8.3"), face.point("8.4")])
    return Lips(upper, lower, weights[0], weights[1], ends)


def openings(skin: Skin, lips: Lips) -> NDArray[np.bool_]:
    """(Q,) whether the way from one lip to the other over the skin goes round a corner of the
    mouth, or through its bag, and not straight across."""
    ends = np.sort(skin.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    ends = np.unique(ends, axis=0)
    length = np.linalg.norm(skin.vertices[ends[:, 0]] - skin.vertices[ends[:, 1]], axis=1)
    edges = sparse.csr_matrix((length, ends.T), (len(skin.vertices),) * 2)
    found = []
    for upper, lower in zip(*lips.nearest(), strict=True):
        aside = np.linalg.norm(lips.corners - skin.vertices[upper], axis=1)
        limit = _SLIT * 2.0 * float(aside.min())
        away = dijkstra(edges, directed=False, indices=upper, limit=limit)
        found.append(np.isinf(away[lower]))
    return np.array(found)


def _carried(skin: Skin, lips: Lips) -> Array:
    """(2Q, N) how far each vertex goes with each point, upper ones first."""
    count = len(lips.upper)
    points = np.concatenate([lips.upper, lips.lower])
    handles = Handles(len(skin.vertices), 2 * count)
    for row, corners in enumerate(points):
        handles.add(corners, np.eye(2 * count)[row], _FIRM)
    places = skin.vertices[points.ravel()]
    near = np.full(len(skin.vertices), np.inf)
    for place in places:
        near = np.minimum(near, np.linalg.norm(skin.vertices - place, axis=1))
    handles.hold(np.flatnonzero(near > _AROUND * lips.width), _FIRM)
    laplacian = uniform_laplacian(skin.triangles.astype(np.intp), len(skin.vertices))
    return spread(laplacian, handles, _STIFFNESS).T
