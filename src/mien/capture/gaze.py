"""Where the eyes look, from the iris against the eye's corners."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.capture.track import ROW
from mien.vocabulary.landmarks import EYE_CORNERS, IRIS

Array = NDArray[np.float64]

_RADIUS = 12.0
"""mm from the centre of an eyeball to its pupil."""
_PITCH_GAIN = 0.4
"""Lids cover the iris above and below: the network sees half of a look up or down and invents
the rest, so it is damped."""
_VERGENCE_FREE = np.radians(6.0)
"""Eyes are averaged unless they cross by more: noise must not make a squint, crossing must. They
never part."""
_RESTING_TURN = np.radians(10.0)
_OPEN = 0.3
"""Closure of an eye that hides nothing of the iris."""


def raw_gaze(lifted: Array) -> Array:
    """(F, 2, 2) yaw (+ left) and pitch (+ up) of the left and right eye, of tracked points
    (F, N, 3) in the head frame, from an unknown rest."""
    eyes = []
    for iris, (outer, inner) in zip(IRIS, EYE_CORNERS, strict=True):
        middle = 0.5 * (lifted[:, ROW[outer]] + lifted[:, ROW[inner]])
        offset = (lifted[:, ROW[iris]] - middle)[:, :2] / _RADIUS
        eyes.append(np.arcsin(np.clip(offset, -0.95, 0.95)))
    return np.stack(eyes, axis=1)


def gaze_rest(raw: Array, head: Array, closure: Array) -> Array:
    """(2, 2) the raw gaze of each eye at rest: its middle over the frames with open eyes
    (``closure`` (F, 2)), since behind lids the network lets the iris sink with them.

    ``head`` (F, 2) is the head's own yaw and pitch. Whoever keeps the head turned from the camera
    mostly looks back at it, so a turn beyond what people rest at is not part of the rest.
    """
    turn = np.median(head, axis=0)
    excess = np.sign(turn) * np.clip(np.abs(turn) - _RESTING_TURN, 0.0, None)
    opened = closure.max(axis=1) < _OPEN
    return np.asarray(np.median(raw[opened] if opened.any() else raw, axis=0) + excess)


def gaze(raw: Array, rest: Array, closure: Array) -> Array:
    """(F, 2, 2) gaze relative to rest, faded out behind shut lids (``closure`` (F, 2))."""
    relative = raw - rest
    both = relative.mean(1, keepdims=True)
    crossed = np.clip(relative[:, 1, 0] - relative[:, 0, 0] - _VERGENCE_FREE, 0.0, None)
    apart = np.zeros_like(relative)
    apart[..., 0] = 0.5 * crossed[:, None] * np.array([-1.0, 1.0])
    seen = np.clip((0.8 - closure.mean(1)) / 0.4, 0.0, 1.0)[:, None, None]
    return np.asarray((both + apart) * np.array([1.0, _PITCH_GAIN]) * seen)
