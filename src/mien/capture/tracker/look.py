"""Looks: what a posed face shows at its texels, and which of it is to be trusted."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.tracker.chart import read
from mien.capture.tracker.crop import Crop
from mien.capture.tracker.person import Person
from mien.capture.tracker.state import State
from mien.capture.tracker.visibility import facing, unhidden

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Bools = NDArray[np.bool_]

BLURS = (2.0, 0.8)
"""mm, sigma of the blur at which pictures are compared: coarse, then fine."""
_SEEN = 0.25
"""Least cosine between skin and line of sight."""


@dataclass(frozen=True, slots=True)
class Look:
    """The skin's grey levels in one frame."""

    levels: tuple[Floats, ...]
    """(M,) at each of BLURS."""
    seen: Bools
    """(M,)"""
    state: State


def pictures(crop: Crop, depth: float, focal: float) -> tuple[Floats, ...]:
    """The crop of a face ``depth`` mm away at each of BLURS."""
    image = crop.image.astype(np.float32)
    millimetre = focal * crop.scale / depth
    return tuple(
        np.asarray(cv2.GaussianBlur(image, (0, 0), max(blur * millimetre, 0.3)), dtype=np.float32)
        for blur in BLURS
    )


def visible(person: Person, crop: Crop, state: State, least: float = _SEEN) -> Bools:
    """(M,) texels that a posed face shows within the crop."""
    places = person.texels.seen(state)
    shape = person.neutral + np.tensordot(state.weights, person.space.expression, axes=1)
    vertices = shape @ state.rotation.T + state.translation
    shown = unhidden(places, vertices, person.space.triangles, person.lens(crop), crop.size)
    return np.asarray(shown & (facing(person.chart, places) > least))


def take(person: Person, crop: Crop, state: State) -> Look:
    """The look of a frame whose state is known."""
    pixels = person.lens(crop).project(person.texels.seen(state))
    blurred = pictures(crop, float(state.translation[2]), person.focal)
    levels = tuple(read(picture, pixels) for picture in blurred)
    return Look(levels, visible(person, crop, state), state)
