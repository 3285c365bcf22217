"""Posing the cage: the jaw turns first, then lids, brows, lips and cheeks pull the skin along."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mien.numeric.biharmonic import Handles, spread
from mien.sculpt.acting import jaw
from mien.sculpt.acting.expression import Expression
from mien.sculpt.anatomy.cage import LIDS, LIPS, cage
from mien.sculpt.anatomy.lids import LidPose, lid_loops
from mien.sculpt.anatomy.lips import ACROSS, FULL, INNER_OVERLAP, SIDE, lip_volumes
from mien.sculpt.brush import ramp
from mien.sculpt.proportions import Proportions
from mien.vocabulary import topology

Array = NDArray[np.float64]

_STIFFNESS = 0.06
_MEAN_HALF_WIDTH = 25.0
_ASIDE = np.abs(ACROSS)
_TO_CORNER = _ASIDE**1.7
_QUARTER = (4 * _ASIDE * (1 - _ASIDE)) ** 1.2
_PUCKER = (0.78, 1.08, 1.05, 0.72)
"""How far each lip loop goes forward in a pucker: the lips turn out."""
_BAG_FOLLOWS = (1.0, 0.9, 0.5, 0.2, 0.1)
_THINNEST = 0.3
_LITTLE = 0.12
_BROW_WEIGHT = 4.0
_VOLUMES = (0.84, 1.16)
"""A lip that would have less of its neutral volume keeps the rest rolled in behind its edge; one
that would have more takes it from there, and is thinner where that is not enough."""
_ROUNDS = 8
_ROLL = 9.0
"""mm back for a whole lip's volume, a first guess."""
_MOST_OUT = 2.6
_UPPER_CLOSES = np.array([0.3, 0.3, 0.0])
"""Part of the way that the upper lip goes to meet the lower: never back, where its teeth are."""

_FOREHEAD = [10, 151, 338, 109, 297, 67, 332, 103, 284, 54, 251, 21, 389, 162, 356, 127, 454, 234]
_FOREHEAD += [323, 93]
_NOSE_RIDGE = [4, 1, 19, 6, 168, 197, 195, 5]
_CHIN_EDGE = [152, 148, 377, 176, 400]
_JAW_ANGLE = [361, 132, 288, 58, 397, 172]
# Left side:
_INNER, _MIDDLE, _OUTER = [285, 336, 295, 296], [282, 334, 295, 296], [283, 293, 276, 300]
_ABOVE_BROW = [337, 299, 333]
_CHEEK, _UNDER_CHEEK = [330, 280, 347, 346], [425, 411]
_PUFF = [425, 436, 427, 434, 416]
_WING = [358, 331, 279, 429]
_FOLD = [423, 426, 436, 432]
_BESIDE_FOLD = [266, 425, 427]
_FROWN = [9, 8]
"""Between the brows, where drawing them together leaves a furrow."""
_FURROW = 0.45
"""mm of its depth a millimetre that a brow's inner end comes in."""


def gains(expression: Expression, across: ArrayLike) -> Array:
    """How strong ``expression`` is at ``across``: -1 at the right, 1 at the left; they meet
    softly in the middle."""
    share = ramp(-0.35, 0.35, across)
    return np.asarray(expression.right + (expression.left - expression.right) * share)


def lid_pose(expression: Expression, side: int) -> LidPose:
    """What the lids of the eye on ``side`` do. The lower lid rises with the last of a blink."""
    gain = expression.left if side > 0 else expression.right
    blink, squint = gain * expression.blink, 0.9 * gain * expression.squint
    lower = max(squint, float(np.clip((blink - 0.3) / 0.7, 0, 1))) if blink > 0 else squint
    return LidPose(blink, lower, gain * expression.lid_tilt, gain * expression.lid_aside)


def posed_cage(neutral: Array, proportions: Proportions, expression: Expression) -> Array:
    """(count, 3) the ``neutral`` cage with ``expression`` on it."""
    flesh = Flesh()
    rest = _lip_volumes(neutral)
    for _ in range(_ROUNDS):
        places = _posed(neutral, proportions, expression, flesh)
        ratio = _lip_volumes(places) / rest
        if (ratio == np.clip(ratio, *_VOLUMES)).all():
            break
        flesh = flesh.nearer(ratio)
    return places


@dataclass(frozen=True, slots=True)
class Flesh:
    """What keeps a lip's volume: of the upper and the lower."""

    thick: Array = field(default_factory=lambda: np.ones(2))
    """Factors of its height."""
    rolled: Array = field(default_factory=lambda: np.zeros(2))
    """mm by which it reaches farther back into the mouth, or less far."""

    def nearer(self, ratio: Array) -> Flesh:
        """The same after volumes were ``ratio`` (2,) times those at rest."""
        least, most = _VOLUMES
        lack, excess = np.maximum(0.0, 1.02 * least - ratio), np.maximum(0.0, ratio - 0.98 * most)
        rolled = np.maximum(self.rolled + _ROLL * (lack - excess), -_MOST_OUT)
        drained = (excess > 0) & (rolled <= -_MOST_OUT)
        return Flesh(self.thick * np.where(drained, np.sqrt(0.99 * most / ratio), 1.0), rolled)


def _lip_volumes(places: Array) -> Array:
    mesh = cage()
    return lip_volumes(mesh.subdivision.matrix[: mesh.count] @ places)


def _posed(neutral: Array, proportions: Proportions, expression: Expression, flesh: Flesh) -> Array:
    mesh = cage()
    places = jaw.turned(neutral, jaw.shares(), expression)
    handles = Handles(mesh.count)
    _hold_still(handles)
    _pull_lids(handles, proportions, expression)
    _pull_brows(handles, proportions, expression)
    _pull_lips(handles, places, neutral, proportions, expression, flesh)
    _pull_cheeks(handles, proportions, expression)
    return places + spread(mesh.laplacian, handles, _STIFFNESS)


def _hold_still(handles: Handles) -> None:
    mesh = cage()
    handles.hold(_NOSE_RIDGE + _FOREHEAD, 2.0)
    handles.hold(_CHIN_EDGE, 0.7)
    handles.hold(_JAW_ANGLE, 0.5)
    handles.hold(mesh.rings[:2].ravel(), 0.6)
    handles.hold(mesh.rings[2:].ravel(), 4.0)


def _pull_lids(handles: Handles, proportions: Proportions, expression: Expression) -> None:
    eye = proportions.eye
    for side, loops, inner in zip((1, -1), LIDS, cage().lid_inner, strict=True):
        rest = lid_loops(eye, side, LidPose())
        now = lid_loops(eye, side, lid_pose(expression, side))
        for vertices, before, after, weight in zip(
            (inner, *loops[:3]), rest, now, (60.0, 60.0, 30.0, 2.0), strict=True
        ):
            handles.add(vertices, after - before, weight)


def _pull_brows(handles: Handles, proportions: Proportions, expression: Expression) -> None:
    for side in (1, -1):
        gain = _side_gain(expression, side) * proportions.temper.brows
        for vertices, push in (
            (_INNER, expression.brow_inner),
            (_MIDDLE, expression.brow_middle),
            (_OUTER, expression.brow_outer),
        ):
            handles.add(_on_side(vertices, side), _push(push, side, gain), _BROW_WEIGHT)
        lift = 0.45 * gain * expression.brow_middle[1]
        handles.add(_on_side(_ABOVE_BROW, side), (0, lift, 0), 0.3)
    between = 0.5 * float(gains(expression, 0.0)) * proportions.temper.brows
    handles.add([9], (0, between * expression.brow_inner[1], 0), 0.5)


def _pull_lips(
    handles: Handles,
    places: Array,
    neutral: Array,
    proportions: Proportions,
    expression: Expression,
    flesh: Flesh,
) -> None:
    """The lips are two wires that move with all their loops; the bag follows the inner edge."""
    mesh, mouth, temper = cage(), proportions.mouth, proportions.temper
    scale = mouth.half_width / _MEAN_HALF_WIDTH
    gain = gains(expression, ACROSS)[:, None]
    upper = SIDE[:, None] > 0
    lower = SIDE[:, None] < 0

    def either(above: ArrayLike, below: ArrayLike) -> Array:
        return np.where(upper, above, np.where(lower, below, 0.0)) * scale

    middle = either(expression.upper_lip, expression.lower_lip) * (1 - _TO_CORNER)[:, None]
    quarter = either(expression.upper_quarter, expression.lower_quarter) * _QUARTER[:, None]
    corner_x, corner_y, corner_z = np.array(expression.corner) * scale
    corner_x *= temper.corners_aside
    corner = np.stack([corner_x * ACROSS, corner_y * _TO_CORNER, corner_z * _TO_CORNER], axis=1)
    thick = np.where(upper, expression.upper_thick, np.where(lower, expression.lower_thick, 1.0))
    # A temper that exaggerates must not turn lips inside out.
    thick = 1 + np.maximum(temper.lip_thickness * (thick - 1), _THINNEST - 1)
    thick = thick * np.where(upper, flesh.thick[0], np.where(lower, flesh.thick[1], 1.0)) - 1
    rolled = np.where(upper, flesh.rolled[0], flesh.rolled[1]) * np.sqrt(FULL)[:, None]
    rolled = np.hstack([0 * rolled, 0.5 * SIDE[:, None] * np.maximum(rolled, 0), -rolled])
    forward = expression.pucker * scale * (1 - 0.35 * _ASIDE**2)
    aside = np.array([expression.lips_aside * scale, 0, 0])
    closing = expression.close * _closing(places, neutral)

    inner = places[LIPS[0]]
    # Lips that thin much need less of the overlap that subdivision opens.
    height = (places[LIPS[3]] - inner) * [0, 1, 0] / (1 + INNER_OVERLAP)
    apart = INNER_OVERLAP * height * np.maximum(-thick - _LITTLE, 0)
    for number, loop in enumerate(LIPS[:4]):
        pull = middle + quarter + corner
        pull[:, 0] -= places[loop, 0] * expression.narrow
        pull[:, 2] += forward * _PUCKER[number]
        pull += thick * (places[loop] - inner) * [1, 1, 0.6]
        pull = gain * (pull + apart) + aside + closing
        handles.add(loop, pull, 60.0)
        if number == 0:
            for ring, share in zip(mesh.bag, _BAG_FOLLOWS, strict=True):
                handles.add(ring, share * (pull + share**3 * rolled), 20.0)
    skin = 0.55 * middle + corner * [0.8, 0.92, 0.7]
    skin[:, 0] -= 0.5 * places[LIPS[4], 0] * expression.narrow
    skin[:, 2] += 0.45 * expression.pucker * scale
    handles.add(LIPS[4], gain * skin + 0.7 * aside + 0.6 * closing, 6.0)
    under_nose = 0.15 * scale * expression.upper_lip[1] * float(gains(expression, 0.0))
    handles.add([2, 94, 98, 327], (0, under_nose, 0), 1.0)


def _closing(places: Array, neutral: Array) -> Array:
    """(20, 3) how the inner edges must move to meet as they did at rest."""
    opposite = LIPS[0][-np.arange(len(LIPS[0])) % len(LIPS[0])]
    parted = (places[opposite] - places[LIPS[0]]) - (neutral[opposite] - neutral[LIPS[0]])
    side = SIDE[:, None]
    share = np.where(side > 0, _UPPER_CLOSES, np.where(side < 0, 1 - _UPPER_CLOSES, 0.0))
    return np.asarray(share * parted)


def _pull_cheeks(handles: Handles, proportions: Proportions, expression: Expression) -> None:
    scale = proportions.mouth.half_width / _MEAN_HALF_WIDTH
    corner = np.array(expression.corner) * scale
    cheek = proportions.temper.cheeks * np.array(expression.cheek)
    for side in (1, -1):
        gain = _side_gain(expression, side)
        handles.add(_on_side(_CHEEK, side), _push(cheek, side, gain), 1.5)
        under = cheek * [0.8, 0.7, 0.7] + corner * [0.3, 0.3, 0]
        handles.add(_on_side(_UNDER_CHEEK, side), _push(under, side, gain), 0.8)
        if expression.puff:
            puff = np.array([0.9, 0, 0.6]) * expression.puff * scale
            handles.add(_on_side(_PUFF, side), _push(puff, side, gain), 2.0)
        if expression.fold:
            fold = np.array([-0.5, 0, -2.0]) * expression.fold + corner * [0.5, 0.5, 0.4]
            handles.add(_on_side(_FOLD, side), _push(fold, side, gain), 3.0)
            ridge = np.array([0.2, 0.3, 1.1]) * expression.fold + corner * [0.4, 0.4, 0.2]
            handles.add(_on_side(_BESIDE_FOLD, side), _push(ridge, side, gain), 2.0)
        wing = np.array([0.35, 1, 0.1]) * expression.nose
        handles.add(_on_side(_WING, side), _push(wing, side, gain), 1.0)
    boss = expression.chin * float(gains(expression, 0.0))
    handles.add([200, 199], (0, boss, 0.2 * abs(boss)), 1.0)


def _side_gain(expression: Expression, side: int) -> float:
    return expression.left if side > 0 else expression.right


def _on_side(left: list[int], side: int) -> Any:
    vertices = np.array(left, dtype=np.intp)
    return vertices if side > 0 else topology.mirrored(vertices)


def _push(push: ArrayLike, side: int, gain: float) -> Array:
    return gain * np.asarray(push, dtype=float) * [side, 1, 1]
