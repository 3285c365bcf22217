"""The jaw: a rotation about the condyles that every vertex follows in part."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from mien.numeric.biharmonic import Handles, spread
from mien.numeric.rotation import from_vector
from mien.sculpt.acting.expression import Expression
from mien.sculpt.anatomy.cage import AROUND, LIDS, LIPS, cage
from mien.sculpt.anatomy.lips import ACROSS, SIDE
from mien.vocabulary import topology

Array = NDArray[np.float64]

PIVOT: Array = np.array([0, 4.0, -30.0])
"""Midway between the condyles, in the sculpting frame."""
_GLIDE = 0.1
"""mm forward a degree: the condyle leaves its socket as the mouth opens."""
_TENSION = 0.05

_CHIN = [199, 200, 175, 152, 18, 83, 313, 182, 406, 201, 421, 194, 418, 208, 428, 32, 262, 140, 369]
_CHIN += [171, 396]
_STILL = [
    2,
    94,
    164,
    98,
    327,
    129,
    358,
    64,
    294,
    48,
    278,
    0,
    37,
    267,
    11,
    12,
    101,
    330,
    36,
    266,
    50,
]
_STILL += [280, 123, 352]
_CHEEK = [205, 425]
_UNDER_CHIN = (0.81, 0.52, 0.26, 0.10)


def turned(places: Array, share: Array | float, expression: Expression) -> Array:
    """(N, 3) ``places`` after the jaw's motion, followed by ``share`` (N,)."""
    share = np.broadcast_to(np.asarray(share, dtype=float), len(places))
    angle = np.radians(expression.jaw) * share
    turn = from_vector(np.stack([angle, 0 * angle, 0 * angle], axis=-1))
    moved = np.einsum("nij,nj->ni", turn, places - PIVOT) + PIVOT
    glide = np.array(
        [expression.jaw_aside, 0, expression.jaw_forward + _GLIDE * max(expression.jaw, 0.0)]
    )
    return np.asarray(moved + share[:, None] * glide)


@cache
def shares() -> Array:
    """(count,) how far each cage vertex follows the jaw: the chin all the way, the lower lip less
    towards the corners, the nose not at all."""
    mesh = cage()
    handles = Handles(mesh.count, 1)

    def follow(vertices: object, share: object, weight: float) -> None:
        target = np.reshape(np.asarray(share, dtype=float), (-1, 1))
        handles.add(np.asarray(vertices), target, weight)

    from_chin = np.abs(np.arange(AROUND) - AROUND // 2)
    below = np.clip(1 - from_chin / 9.0, 0, 1) ** 0.7
    for ring, share in zip(mesh.rings, [*_UNDER_CHIN] + [0.0] * 11, strict=True):
        follow(ring, share * below, 20)
    follow(topology.SILHOUETTE, np.clip(1.9 * np.clip(1 - from_chin / 10.0, 0, 1), 0, 1), 5)
    follow(_CHIN, 1.0, 20)
    follow(_STILL, 0.0, 3)
    follow(_CHEEK, 0.12, 1)
    aside = np.abs(ACROSS) ** 4
    lips = np.where(SIDE > 0, 0.46 * aside, np.where(SIDE < 0, 1 - 0.54 * aside, 0.46))
    for loop in LIPS[:4]:
        follow(loop, lips, 40)
    skin = np.where(SIDE > 0, 0.40 * aside, np.where(SIDE < 0, 1 - 0.55 * aside, 0.42))
    follow(LIPS[4], skin, 5)
    for ring, part in zip(mesh.bag, (1, 1, 0.95, 0.8, 0.6), strict=True):
        follow(ring, part * lips, 40)
    follow(mesh.bag_end, 0.3, 20)
    for loops in LIDS:
        follow(loops.ravel(), 0.0, 10)
    found = np.clip(spread(mesh.laplacian, handles, _TENSION)[:, 0], 0, 1)
    return np.asarray(0.5 * (found + found[mesh.mirror]))
