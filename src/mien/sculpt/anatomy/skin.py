"""The skin: the subdivided cage, kept clear of the eyeballs; and where on it things are."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from mien.sculpt.anatomy.cage import LIDS, LIPS, cage
from mien.sculpt.anatomy.lids import eye_frame
from mien.sculpt.proportions import EyeShape
from mien.vocabulary import topology

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Labels:
    """(fine,) each: 1 where the skin belongs there, fading over a triangle."""

    mask: Array
    lips: Array
    inner_lips: Array
    bag: Array
    lid_edge: Array
    """Margin and roll."""
    lid_inside: Array
    eye_area: Array


@cache
def labels() -> Labels:
    """The labels of the one skin there is; do not write into them."""
    mesh = cage()
    area = sum(
        share * mesh.label(np.concatenate([loops[ring] for loops in LIDS]))
        for ring, share in ((0, 1.0), (1, 0.8), (2, 0.35))
    )
    return Labels(
        mask=mesh.label(np.arange(topology.LANDMARKS)),
        lips=mesh.label(LIPS[:4].ravel()),
        inner_lips=mesh.label(LIPS[:2].ravel()),
        bag=mesh.label(np.append(mesh.bag.ravel(), mesh.bag_end)),
        lid_edge=mesh.label(np.concatenate([loops[:2].ravel() for loops in LIDS])),
        lid_inside=mesh.label(mesh.lid_inner.ravel()),
        eye_area=np.asarray(area),
    )


def clear_of_eyes(skin: Array, eye: EyeShape) -> Array:
    """(fine, 3) ``skin`` pushed out of the eyeballs where it would cut them."""
    label, skin = labels(), skin.copy()
    outside = (label.lid_inside < 0.02) & (label.mask > 0.9)
    clearance = eye.radius + eye.offset * np.where(label.lid_edge > 0.3, 0.95, 0.7)
    for side in (1, -1):
        frame = eye_frame(eye, side, eye.lid_turn)
        ray = skin - frame.centre
        distance = np.linalg.norm(ray, axis=1)
        ahead = ray @ frame.ahead > -0.2 * eye.radius
        low = outside & ahead & (skin[:, 0] * side > 0) & (distance < clearance)
        skin[low] = frame.centre + ray[low] * (clearance[low] / distance[low])[:, None]
    return skin
