"""Eyes and lids: every lid point is placed by arc length on the eyeball, so that lids slide."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mien.sculpt.anatomy.cage import LID_AROUND
from mien.sculpt.proportions import EyeShape

Array = NDArray[np.float64]

_AROUND = np.arange(LID_AROUND)
_ANGLE = np.pi * _AROUND / 8
UPPER = (_AROUND > 0) & (_AROUND < 8)
LOWER = _AROUND > 8
"""Positions of the lid loops on either lid; 0 is the outer corner, 8 the inner."""
_OUTWARD = np.stack([0.9 * np.cos(_ANGLE), np.sin(_ANGLE)], axis=1)
_OUTWARD /= np.linalg.norm(_OUTWARD, axis=1, keepdims=True)
_MEET = 0.62
"""Closed lids meet at this part of the lower lid's depth: the lower lid rises the rest."""
_TILT_BELOW = 0.4
"""Part of a tilt that the lower lid follows, or a tilted eye would not close."""
_CORNER = 0.24
"""The corners sink by this part of what the middle of the meeting line lies lower: lids that went
past them would turn over."""
_MIDDLE = 0.27
"""The middle passes less far: lids that are closed as far as the feature points there tell are
closed all along."""
_BULGE = 0.8
"""mm by which a closed upper lid stands off farther: one that was wide open is moved by more than
a blink, along the same chord."""
_OVERLAP = 0.048
"""Part of the opening by which each closed margin of the cage passes the meeting line: subdivision
draws it back by as much."""


@dataclass(frozen=True, slots=True)
class LidPose:
    """0 is the neutral."""

    upper: float = 0.0
    """1 closed, negative opens wider."""
    lower: float = 0.0
    """1 raised to the meeting line."""
    tilt: float = 0.0
    """Positive: the inner end of the upper lid goes up (sad), negative down (angry); tenths of
    the upper lid's height."""
    aside: float = 0.0
    """mm the lids' middle follows the gaze, positive outwards."""


@dataclass(frozen=True, slots=True)
class Frame:
    """Where an eye is and how it is turned; ``out`` towards the temple."""

    centre: Array
    out: Array
    up: Array
    ahead: Array

    def place(self, across: Array, above: Array, distance: ArrayLike) -> Array:
        """(N, 3) points at arc lengths ``across``, ``above`` on the ball of ``radius`` the arcs
        were measured on, ``distance`` from its centre: angles in radians here."""
        angle = np.hypot(across, above) + 1e-12
        share = np.sin(angle) / angle
        ray = (
            self.out * (across * share)[:, None]
            + self.up * (above * share)[:, None]
            + self.ahead * np.cos(angle)[:, None]
        )
        return np.asarray(self.centre + ray * np.reshape(distance, (-1, 1)))


def eye_frame(eye: EyeShape, side: int, turn: float) -> Frame:
    """The eye on ``side`` (1 left, -1 right), turned outwards by ``turn`` degrees."""
    angle = np.radians(turn)
    return Frame(
        centre=np.array([side * eye.aside, eye.height, eye.depth]),
        out=np.array([side * np.cos(angle), 0, -np.sin(angle)]),
        up=np.array([0, 1.0, 0]),
        ahead=np.array([side * np.sin(angle), 0, np.cos(angle)]),
    )


def on_ball(eye: EyeShape, side: int, across: Array, above: Array, distance: ArrayLike) -> Array:
    """Points of the lid frame at arc lengths in mm on the ball's surface."""
    frame = eye_frame(eye, side, eye.lid_turn)
    return frame.place(np.asarray(across) / eye.radius, np.asarray(above) / eye.radius, distance)


def margin(eye: EyeShape, pose: LidPose) -> tuple[Array, Array]:
    """Arc lengths (16,) across and above of the lid margin: an almond."""
    sine, cosine = np.abs(np.sin(_ANGLE)), np.cos(_ANGLE)
    across = eye.half_width * cosine
    top = eye.upper * sine**0.85 * (1 - eye.peak * cosine)
    bottom = -eye.lower * sine**0.9 * (1 + 1.3 * eye.peak * cosine)
    meet = -_MEET * eye.lower * (_CORNER + (1 - _CORNER) * sine**2.4)
    meet *= 1 + 1.3 * eye.peak * cosine * sine
    tilt = pose.tilt * eye.upper / 10 * cosine * sine**0.8
    top, bottom = top - tilt, bottom - _TILT_BELOW * tilt
    # Nothing to pass at the corners, where the lids hang together.
    past = (_OVERLAP * (eye.upper + eye.lower) + 0.25) * (sine**0.7 - _MIDDLE * sine**24)
    top = top + (meet - past - top) * pose.upper
    bottom = bottom + (meet + past - bottom) * pose.lower
    corner = meet * max(pose.upper, 0.0)
    above = np.where(UPPER, top, np.where(LOWER, bottom, corner))
    return across + pose.aside * sine, above + eye.tilt * cosine


def lid_loops(eye: EyeShape, side: int, pose: LidPose) -> tuple[Array, Array, Array, Array]:
    """(16, 3) each: inner edge, margin, roll and crease. The farther from the margin, the less a
    loop rides with it."""
    rest = eye.radius + eye.offset
    across, above = margin(eye, pose)
    tuck = np.where(UPPER, 1 - 0.5 * pose.upper, 1.0)
    inner = on_ball(
        eye,
        side,
        across + 0.6 * _OUTWARD[:, 0],
        above + 1.2 * tuck * _OUTWARD[:, 1],
        eye.radius - 1.5,
    )
    edge = on_ball(eye, side, across, above, rest)
    wide = np.where(LOWER, 2.2, 2.6)
    u, v = margin(eye, LidPose(0.66 * pose.upper, 0.6 * pose.lower, 0.7 * pose.tilt, pose.aside))
    roll = on_ball(
        eye,
        side,
        u + wide * _OUTWARD[:, 0],
        v + wide * _OUTWARD[:, 1],
        rest + np.where(UPPER, 0.9 + _BULGE * max(pose.upper, 0.0), 0.45),
    )
    wide = np.where(UPPER, eye.crease, 6.5)
    u, v = margin(eye, LidPose(0.16 * pose.upper, 0.2 * pose.lower, 0.25 * pose.tilt))
    crease = on_ball(
        eye,
        side,
        u + wide * _OUTWARD[:, 0],
        v + wide * _OUTWARD[:, 1],
        rest + np.where(UPPER, eye.crease_offset, 0.2),
    )
    return inner, edge, roll, crease
