"""Key models that follow what an artist has sculpted of a face.

A shape that is known to be a key model takes its place, and, turned over, that of its partner on
the other side. Any other is a pose: some mixture of key models, that shows how this artist makes
them. Li, Weise and Pauly (Example-Based Facial Rigging, 2010):

    minimise  sum_j |S_j - sum_i a_ji B_i|²  +  doubt sum_i |B_i - A_i|² / s_i²

    S_j   a pose, motion of the skin                          (M, N, 3)
    A_i   the key models by transfer; B_i those that are sought (K, N, 3)
    a_ji  how much of each is in a pose, 0..1                 (M, K)
    s_i   by how much a key model may be mistaken: as far as it moves, a vertex at a time

Mixtures and key models take turns: either, with the other held, is a small linear problem.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array
from mien.numeric.facing import ClosestPoints
from mien.numeric.normals import vertex_normals
from mien.numeric.qp import solve_boxes
from mien.sculpt.transfer.shapes import NOT_BY_POINTS
from mien.sculpt.transfer.skin import Skin

_TURNS = 3
_FREE = 0.02
"""Part of a key model's farthest motion by which it may move what it does not."""
_DOUBT = 0.3
"""Part of what a pose shows at a vertex that its mixture may be wrong by: it is a guess ..."""
_LEAST = 0.1
"""... and mm of it in any case."""
_SPARING = 1e-4
"""What a weight of 1 costs, in a pose's own squared length ..."""
_PRICE = 0.05
"""... and what motion costs while it is asked which key models are in a pose at all."""
_PART = 0.05
"""Weight from which one is."""
_ABSENT = 1e-6
"""Nothing, for a solver whose bounds must differ."""
_TOLD = 0.3
"""Part of a pose, squared, that key models must explain for it to be one of the face."""
_SYMMETRIC = 4.0
"""mm from a vertex turned over to the skin, at which the two sides still answer to each other."""
_TURNED = 18.0
_AT_ONCE = 2048
"""Vertices solved together, which bounds memory."""
_MOST = 64
"""Poses that are looked at: those that move the skin most."""


@dataclass(frozen=True, slots=True)
class Followed:
    """Key models that follow an artist's."""

    made: Array
    """(K, N, 3) mm."""
    mixtures: Mapping[str, Mapping[str, float]]
    """Of each pose that was understood, how much of each key model is in it."""


def follow(
    made: Array,
    names: Sequence[str],
    skin: Skin,
    own: Mapping[str, Array],
    poses: Mapping[str, Array],
) -> Followed:
    """``made`` (K, N, 3), key models ``names`` by transfer, drawn to what was sculpted of the same
    ``skin``: ``own`` (N, 3) by the key model each is, ``poses`` (N, 3) by their own names."""
    made = made.copy()
    sure = np.zeros(made.shape[:2])
    turned = _Mirror(skin)
    for name, field in own.items():
        other = mirrored_name(name)
        if other not in own and other in names:
            row = names.index(other)
            made[row] += turned.belief[:, None] * (turned(field) - made[row])
            sure[row] = turned.belief
    for name, field in own.items():
        made[names.index(name)] = field
        sure[names.index(name)] = 1.0
    moving = {name: field for name, field in poses.items() if field.any()}
    most = sorted(moving, key=lambda name: -float((moving[name] ** 2).sum()))[:_MOST]
    if not most:
        return Followed(made, {})
    area = skin.areas()
    fields = np.stack([moving[name] for name in most])
    able = np.where([name.startswith(NOT_BY_POINTS) for name in names], _ABSENT, 1.0)
    told = _mixtures(made, fields, area, able).explained > _TOLD
    if not told.any():
        return Followed(made, {})
    kept = [name for name, known in zip(most, told, strict=True) if known]
    prior = _prior(made) * (1.0 - sure)
    found = _take_turns(made, fields[told], area, able, prior, _partners(names), turned)
    mixtures = {
        pose: {name: float(level) for name, level in zip(names, row, strict=True) if level > 0.05}
        for pose, row in zip(kept, found.weights, strict=True)
    }
    return Followed(found.made, mixtures)


def mirrored_name(name: str) -> str:
    """The name of the same shape on the other side, "eyeBlinkRight" or "smile_right"."""
    swap = {"Left": "Right", "Right": "Left", "left": "right", "right": "left"}
    for word, other in swap.items():
        if name.endswith(word):
            return name.removesuffix(word) + other
    return name


def _partners(names: Sequence[str]) -> NDArray[np.intp]:
    """(K,) row of each key model's partner on the other side; its own where there is none."""
    row = {name: i for i, name in enumerate(names)}
    return np.array([row.get(mirrored_name(name), i) for name, i in row.items()], dtype=np.intp)


class _Mirror:
    """Motion of a skin, turned over to its other side."""

    def __init__(self, skin: Skin) -> None:
        flip = np.array([-1.0, 1.0, 1.0])
        normals = vertex_normals(skin.vertices, skin.triangles)
        search = ClosestPoints(skin.vertices, skin.triangles)
        found = search(skin.vertices * flip, normals * flip, _TURNED)
        self._at = found.matrix(skin.triangles, len(skin.vertices))
        near = np.exp(-((found.distance / _SYMMETRIC) ** 2))
        self.belief: Array = near * np.clip(0.5 + found.facing, 0.0, 1.0)
        """(N,) 0..1."""

    def __call__(self, field: Array) -> Array:
        """(N, 3) from (N, 3)."""
        return np.asarray((self._at @ field) * [-1.0, 1.0, 1.0])


@dataclass(frozen=True, slots=True)
class _Mixed:
    weights: Array
    """(M, K)"""
    explained: Array
    """(M,) part of each pose, squared."""


def _mixtures(made: Array, poses: Array, area: Array, most: Array) -> _Mixed:
    """How much of each key model is in each pose, by bounded least squares over the skin, up to
    ``most`` (K,) of each; first with a price on motion, so that key models that undo each other
    are left out."""
    root = np.sqrt(area)[:, None]
    basis = (made * root).reshape(len(made), -1)
    wanted = (poses * root).reshape(len(poses), -1)
    gram = basis @ basis.T
    reach = np.sqrt(np.diag(gram))
    none = np.zeros(len(made))
    weights = []
    for pose in wanted:
        length = float(pose @ pose)
        hessian = (gram / length + _SPARING * np.eye(len(made)))[None]
        onto = basis @ pose / length
        priced = _PRICE * reach / np.sqrt(length) - onto
        few = solve_boxes(hessian, priced[None], none, most)[0] > _PART
        weights.append(solve_boxes(hessian, -onto[None], none, np.where(few, most, _ABSENT))[0])
    left = ((wanted - np.stack(weights) @ basis) ** 2).sum(axis=1)
    return _Mixed(np.stack(weights), 1.0 - left / (wanted**2).sum(axis=1))


@dataclass(frozen=True, slots=True)
class _Turns:
    made: Array
    weights: Array


def _take_turns(
    made: Array,
    poses: Array,
    area: Array,
    able: Array,
    prior: Array,
    partners: NDArray[np.intp],
    turned: _Mirror,
) -> _Turns:
    """Key models that show the ``poses`` (M, N, 3), each as it is and turned over."""
    both = np.concatenate([poses, np.stack([turned(field) for field in poses])])
    belief = np.concatenate([np.ones(poses.shape[:2]), np.tile(turned.belief, (len(poses), 1))])
    current = made
    for _ in range(_TURNS):
        weights = _mixtures(current, poses, area, able).weights
        mixed = np.concatenate([weights, weights[:, partners]])
        current = made + _corrections(made, both, mixed, prior, belief)
    return _Turns(current, weights)


def _prior(made: Array) -> Array:
    """(K, N) mm², by how much a key model may be mistaken at a vertex, squared."""
    size = np.linalg.norm(made, axis=2)
    return np.asarray((size + _FREE * size.max(axis=1, keepdims=True)) ** 2)


def _corrections(made: Array, poses: Array, mixed: Array, prior: Array, belief: Array) -> Array:
    """(K, N, 3) the likeliest by which key models at ``mixed`` (M, K) show the ``poses``
    (M, N, 3), as far as each is believed (M, N)."""
    found = np.zeros_like(made)
    doubt = (_DOUBT**2 * (poses**2).sum(axis=2) + _LEAST**2) / np.maximum(belief, 1e-3)
    eye = np.eye(len(poses))
    for first in range(0, made.shape[1], _AT_ONCE):
        run = slice(first, first + _AT_ONCE)
        missed = poses[:, run] - np.einsum("mk,knx->mnx", mixed, made[:, run])
        spread = mixed[None] * prior[:, run].T[:, None, :]
        gram = spread @ mixed.T + doubt[:, run].T[:, :, None] * eye
        solved = np.linalg.solve(gram, missed.transpose(1, 0, 2))
        found[:, run] = np.einsum("nmk,nmx->knx", spread, solved)
    return found
