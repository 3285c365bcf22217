"""How far each eye is shut, against the performer's own open and shut."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.capture.track import ROW
from mien.errors import InputError
from mien.vocabulary.landmarks import EYE_CORNERS, LOWER_LID, UPPER_LID

Array = NDArray[np.float64]

_AJAR = 0.7
"""Part of the open eye at which nobody calls it shut."""


@dataclass(frozen=True, slots=True)
class LidRange:
    """Opening (lid height over eye width) of the left and right eye at rest and shut."""

    open: Array
    """(2,)"""
    shut: Array
    """(2,)"""


def eye_widths(neutral: Array) -> Array:
    """(2,) mm between the corners of the left and right eye of ``neutral`` (N, 3)."""
    return np.array(
        [np.linalg.norm(neutral[ROW[outer]] - neutral[ROW[inner]]) for outer, inner in EYE_CORNERS]
    )


def openings(lifted: Array, neutral: Array) -> Array:
    """(F, 2) lid height of the left and right eye over its width at rest.

    ``lifted`` (F, N, 3) are the tracked points in the head frame, so a turn of the head does not
    look like a blink; ``neutral`` (N, 3).
    """
    eyes = []
    for upper, lower, width in zip(UPPER_LID, LOWER_LID, eye_widths(neutral), strict=True):
        height = np.mean(
            [
                lifted[:, ROW[u], 1] - lifted[:, ROW[d], 1]
                for u, d in zip(upper, lower, strict=True)
            ],
            axis=0,
        )
        eyes.append(height / width)
    return np.stack(eyes, axis=1)


def lid_range(take: Array, rest: Array) -> LidRange:
    """Calibrate from the openings of a take (F, 2) and of its neutral frames (G, 2).

    Nobody rests with eyes narrower than the take's middle, and few takes hold both eyes shut for
    long: the shut eye is the narrowest per cent of the take, within what lids do.
    """
    opened = np.maximum(np.median(rest, axis=0), np.median(take, axis=0))
    shut = np.clip(np.quantile(take, 0.01, axis=0), 0.15 * opened, 0.45 * opened)
    return LidRange(opened, shut)


def with_shut(span: LidRange, shut: Array) -> LidRange:
    """``span`` of somebody whose eyes are shut at the openings ``shut`` (G, 2). Raises InputError
    where they are not."""
    middle = np.median(shut, axis=0)
    if (middle > _AJAR * span.open).any():
        raise InputError("the eyes were not shut; shut both and hold them")
    return LidRange(span.open, middle)


def closures(opening: Array, span: LidRange, yaw: Array) -> Array:
    """(F, 2) closure of the left and right eye: 0 open, 1 shut, below 0 wider than at rest.

    ``yaw`` (F,) radians, + to the performer's left: the far eye of a turned head is hardly seen
    and follows the near one; but how wide the near one opens says nothing of a lid that falls.
    """
    closure = (span.open - opening) / (span.open - span.shut)
    # The network reports the last part of a blink weakly and trembles about open.
    closure = closure * (1.0 + 0.35 * np.clip(closure - 0.35, 0.0, 0.4))
    closure = np.where(np.abs(closure) < 0.12, closure * np.abs(closure) / 0.12, closure)
    share = np.clip((np.degrees(np.abs(yaw)) - 15.0) / (28.0 - 15.0), 0.0, 1.0)
    left, right = closure[:, 0], closure[:, 1]
    left_is_far = yaw > 0.0
    return np.stack(
        [
            np.where(left_is_far, _led(left, right, share), left),
            np.where(left_is_far, right, _led(right, left, share)),
        ],
        axis=1,
    )


def _led(far: Array, near: Array, share: Array) -> Array:
    """(F,) the far eye's closure with a ``share`` of the near one's."""
    leader = np.where(far > 0.0, np.maximum(near, 0.0), near)
    return np.asarray(far + share * (leader - far))


def paired(closure: Array, height: Array) -> Array:
    """(F, 2) ``closure`` without the last pixel by which the two eyes differ.

    ``height`` (F, 2) pixels of the open eyes: in a small picture that much is noise, and makes
    winks that are none.
    """
    apart = np.diff(closure, axis=1)
    known = np.sign(apart) * np.maximum(np.abs(apart) - 1.0 / height.mean(axis=1)[:, None], 0.0)
    return np.asarray(closure.mean(axis=1, keepdims=True) + known * (-0.5, 0.5))
