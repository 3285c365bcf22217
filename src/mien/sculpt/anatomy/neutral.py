"""A head at rest: the mean head brushed to its proportions, then eyes, lips and nostrils set in."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.numeric.biharmonic import Handles, spread
from mien.sculpt.anatomy.cage import LIDS, LIPS, cage
from mien.sculpt.anatomy.lids import LOWER, UPPER, LidPose, lid_loops
from mien.sculpt.anatomy.lips import bag_loops, lip_loops
from mien.sculpt.anatomy.skull import mean_head
from mien.sculpt.brush import bump, ramp, sided
from mien.sculpt.proportions import HeadShape, Proportions
from mien.vocabulary import topology

Array = NDArray[np.float64]

_STIFFNESS = 0.01
_ANCHORS = [10, 151, 9, 8, 168, 6, 197, 195, 5, 4, 1, 19, 2, 94, 152, 148, 377, 234, 454, 127, 356]
_ANCHORS += [54, 284, 21, 251, 172, 397, 58, 288, 200, 199, 98, 327, 129, 358, 64, 294]
"""Landmarks of nose, brow, chin and silhouette that keep the brushed form loosely."""


def neutral_cage(proportions: Proportions) -> Array:
    """(count, 3) the cage of a head at rest, its own mirror image."""
    mesh = cage()
    places = _brushed(mean_head(), proportions.head)
    handles = Handles(mesh.count)
    _set_eyes(handles, places, proportions)
    _set_mouth(handles, places, proportions)
    for nostril in (topology.NOSTRIL, topology.mirrored(topology.NOSTRIL)):
        handles.add(nostril, (0, proportions.head.nostril, -2.2), 6.0)
    handles.hold(_ANCHORS, 0.6)
    handles.hold(mesh.rings.ravel(), 2.0)
    return mesh.symmetrised(places + spread(mesh.laplacian, handles, _STIFFNESS))


def _set_eyes(handles: Handles, places: Array, proportions: Proportions) -> None:
    eye, head = proportions.eye, proportions.head
    for side, loops, inner in zip((1, -1), LIDS, cage().lid_inner, strict=True):
        tuck, margin, roll, crease = lid_loops(eye, side, LidPose())
        for vertices, target, weight in (
            (inner, tuck, 50.0),
            (loops[0], margin, 50.0),
            (loops[1], roll, 30.0),
            (loops[2][UPPER], crease[UPPER], 8.0),
        ):
            handles.add(vertices, target - places[vertices], weight)
        # The lower crease is left almost free, or it draws bags under the eyes.
        below = loops[2][LOWER]
        handles.add(below, 0.3 * (crease[LOWER] - places[below]), 0.15)
        handles.add(loops[3][2:7], (0, head.brow_up, head.brow_forward), 1.0)


def _set_mouth(handles: Handles, places: Array, proportions: Proportions) -> None:
    mesh = cage()
    loops = lip_loops(proportions.mouth)
    for vertices, target in zip(LIPS, loops, strict=False):
        handles.add(vertices, target - places[vertices], 40.0)
    bag, end = bag_loops(loops[0])
    handles.add(mesh.bag, (bag - places[mesh.bag]).reshape(-1, 3), 20.0)
    handles.add(mesh.bag_end, end - places[mesh.bag_end], 20.0)


def _brushed(mean: Array, head: HeadShape) -> Array:
    """The mean head in this head's proportions, as far as broad brushes go."""
    places = mean.copy()
    height = mean[:, 1]
    middle = np.array([0, 26, -40.0])
    places += (places - middle) * (np.array(head.cranium) - 1) * ramp(10, 70, height)[:, None]
    places += bump(places, (0, 128, -62), (75, 45, 62))[:, None] * [0, head.crown, -2.0]

    places[:, 0] *= 1 + (head.face_width - 1) * ramp(-150, -100, height)
    jaw = (1 - ramp(-75, 10, height)) * ramp(-125, -95, height)
    places[:, 0] *= 1 + (head.jaw_width - 1) * jaw

    places[:, 1] += np.clip(18 - height, 0, 38) * (1 - head.midface)
    places[:, 1] += np.clip(-20 - height, 0, 75) * (1 - head.lower_face)
    chin = np.exp(-(((places - [0, -88, 42]) / [24, 22, 30]) ** 2).sum(axis=1))
    places += chin[:, None] * [0, head.chin_up, head.chin_forward]
    places = _narrowed_neck(places, height, head.neck)

    cheek = bump(places, (48, -8, 34), (20, 20, 26))
    places += head.cheek * cheek[:, None] * sided(places, (0.6, 0.3, 0.9))
    for brush in head.brushes:
        places += bump(places, brush.centre, brush.radii)[:, None] * sided(places, brush.push)

    root = np.array([0, head.nose_up - 4, 50.0])
    nose = np.exp(-((((places - [0, -3, 64]) / [26, 30, 30]) ** 2).sum(axis=1) ** 2))[:, None]
    return np.asarray(
        places + nose * ((places - root) * (np.array(head.nose) - 1) + [0, head.nose_up, 0])
    )


def _narrowed_neck(places: Array, height: Array, width: float) -> Array:
    """Only rings move: the jaw belongs to the face."""
    mesh = cage()
    share = np.zeros(mesh.count)
    for ring, weight in zip(mesh.rings, [0.12, 0.45, 0.8] + [1.0] * 12, strict=True):
        share[ring] = weight
    share *= (1 - ramp(-118, -48, height)) * (places[:, 2] < 40)
    return places + (places - [0, 0, -58.0]) * [1, 0, 1] * (width - 1) * share[:, None]
