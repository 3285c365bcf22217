"""Easing a posed skin where its triangles would turn over.

Slivers, which no mesh of a face is without, turn right round when a corner moves by a hair's
breadth. Their motion is stiffened:

    minimise  sum of w |m - m0|² over vertices + sum of k A |grad m|² over offending triangles

with m the skin's motion, m0 what it would be, A a triangle's area at rest, and k growing for as
long as the triangle offends. A triangle that is stiff enough only goes along.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.linalg import spsolve

from mien.sculpt.anatomy.cage import LIDS, LIPS, cage
from mien.sculpt.anatomy.skin import clear_of_eyes, labels
from mien.sculpt.proportions import EyeShape
from mien.sculpt.soundness import along, turned

Array = NDArray[np.float64]

_MOST = 82.0
"""Degrees: less than what is sound, for key models are mixed."""
_MOST_BEYOND = 100.0
"""Under the jaw, where skin folds, stiff triangles would show."""
_PARTS = (0.5, 1.0, 1.4)
"""Weights of the pose that are looked at: key models move along chords, and what is mixed with
one moves the skin further ..."""
_GIVE_WAY = 1.0
"""... but lids' edges no further than this: they give way to blinks."""
_ROUNDS = 24
_STIFFER, _ABOUT = 0.4, 0.15
"""What an offending triangle's k gains in the first round, and that of those about it."""
_GROWTH = 1.4


def eased(neutral: Array, posed: Array, eye: EyeShape) -> Array:
    """(fine, 3) the ``posed`` skin, its motion from ``neutral`` stiffer where triangles turn."""
    wanted = posed - neutral
    limit = np.where(_beyond_the_face(), _MOST_BEYOND, _MOST)
    best, least = wanted, np.inf
    motion, stiff, gain = wanted, np.zeros(len(cage().subdivision.triangles)), 1.0
    for _ in range(_ROUNDS):
        most = np.max([_turned_by(neutral, part * motion, part) for part in _PARTS], axis=0)
        over = most > limit
        # Some triangles cannot be kept from it, and all about them would go stiff in vain.
        excess = float((most - limit)[over].sum())
        if excess < least:
            best, least = motion, excess
        if not over.any():
            break
        near = _adjacent() @ over.astype(float) > 0
        stiff += gain * (_STIFFER * over + _ABOUT * near)
        gain *= _GROWTH
        motion = _stiffened(neutral, wanted, stiff)
        motion = clear_of_eyes(neutral + motion, eye) - neutral
    return np.asarray(neutral + best)


def _turned_by(neutral: Array, motion: Array, part: float) -> Array:
    degrees = turned(neutral, neutral + motion)
    return np.where(_lid_edges(), 0.0, degrees) if part > _GIVE_WAY else degrees


def _stiffened(neutral: Array, wanted: Array, stiff: Array) -> Array:
    """(fine, 3) motion that minimises the sum above."""
    chosen = stiff > 0
    triangles, k = cage().subdivision.triangles[chosen], stiff[chosen]
    active, local = np.unique(triangles, return_inverse=True)
    local = local.reshape(-1, 3)
    rows, columns, values = [], [], []
    for corner in range(3):
        apex, here, there = (triangles[:, (corner + n) % 3] for n in range(3))
        p, q = neutral[here] - neutral[apex], neutral[there] - neutral[apex]
        # The cotangent of the angle at the apex weighs the edge across from it.
        area = np.linalg.norm(np.cross(p, q), axis=1) + 1e-9
        weight = 0.5 * k * (p * q).sum(axis=1) / area
        i, j = local[:, (corner + 1) % 3], local[:, (corner + 2) % 3]
        rows += [i, j, i, j]
        columns += [i, j, j, i]
        values += [weight, weight, -weight, -weight]
    count = len(active)
    where = (np.concatenate(rows), np.concatenate(columns))
    membrane = sparse.coo_matrix((np.concatenate(values), where), (count, count))
    firm = _firmness()[active]
    system = (membrane + sparse.diags(firm)).tocsc()
    motion = wanted.copy()
    motion[active] = spsolve(system, firm[:, None] * wanted[active])
    return motion


@cache
def _beyond_the_face() -> NDArray[np.bool_]:
    """(T,) triangles of skull and neck."""
    label = labels()
    face = label.mask + label.lid_inside + label.bag
    return np.asarray(face[cage().subdivision.triangles].min(axis=1) < 0.9)


@cache
def _lid_edges() -> NDArray[np.bool_]:
    """(T,) triangles of lids' margins and of what lies next to them."""
    return np.asarray(labels().lid_edge[cage().subdivision.triangles].max(axis=1) > 0.05)


@cache
def _firmness() -> Array:
    """(fine,) w: the edges of lids and lips must meet."""
    firm = np.ones(len(cage().fine_mirror))
    for loop, weight in ((LIPS[0], 4.0), *((lid[0], 1e5) for lid in LIDS)):
        firm[along(np.append(loop, loop[0]))] = weight
    return firm


@cache
def _adjacent() -> sparse.csr_matrix:
    """(T, T): which triangles share a corner."""
    triangles = cage().subdivision.triangles
    count = len(triangles)
    corners = sparse.csr_matrix(
        (np.ones(3 * count), (np.repeat(np.arange(count), 3), triangles.ravel()))
    )
    return (corners @ corners.T).tocsr()
