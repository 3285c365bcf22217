"""The transformed pictures in which features are sought: one field for each rectangle."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.colour.skin import gains, skin_colour
from mien.capture.snakes.colour.transform import (
    USUAL_WEIGHTS,
    Field,
    Weights,
    brightness,
    neighbourhood,
    transform,
    window,
)
from mien.capture.snakes.curves.blobs import above, without_hair
from mien.capture.snakes.curves.features import Feature
from mien.capture.snakes.head.patch import COARSE, HEIGHT, ORIGIN, WIDTH, Picture

Array = NDArray[np.float64]

_SMALL = (WIDTH // COARSE, HEIGHT // COARSE)


@dataclass(frozen=True, slots=True)
class Look:
    """A patch and what all its transformations share."""

    patch: Picture
    small: Picture
    """(H / 2, W / 2, 3) the patch at COARSE patch units a pixel."""
    gains: Array
    """(3,) factors that make its skin USUAL_SKIN."""
    value: Field
    """(H / 2, W / 2) brightness of the small patch after scaling."""
    mean: Field
    """(H / 2, W / 2) the neighbourhood's."""

    def at(self, pitch: int) -> Picture:
        """The patch at ``pitch`` patch units a pixel."""
        return self.patch if pitch == 1 else self.small


Weigh = Callable[[Look, Array], Mapping[str, Weights]]
"""Weights of each group for a look and the lenses (L, 6, 2) expected in it."""


def usual_weights(look: Look, lenses: Array) -> Mapping[str, Weights]:
    """Those that serve most people."""
    return USUAL_WEIGHTS


def look_at(patch: Picture, factors: Array | None = None) -> Look:
    """``patch`` scaled by its own skin, or by ``factors`` (3,) known from elsewhere."""
    factors = gains(skin_colour(patch)) if factors is None else factors
    small = np.asarray(cv2.resize(patch, _SMALL, interpolation=cv2.INTER_AREA), dtype=np.uint8)
    value = brightness(small, factors)
    return Look(patch, small, factors, value, neighbourhood(value))


@cache
def corner_of(feature: Feature) -> Array:
    """(2,) patch units of the first pixel's centre of the field it is sought in."""
    left, top, _, _ = window(feature.box, feature.pitch)
    first = feature.pitch * np.array([left, top]) + 0.5 * (feature.pitch - 1)
    return np.asarray(first - ORIGIN, dtype=float)


def field_of(look: Look, feature: Feature, weights: Mapping[str, Weights]) -> Field:
    """I of a feature's rectangle. An eye is what is dark or what is white."""
    groups = ("eye", "sclera") if feature.group == "eye" else (feature.group,)
    rows = [weights[group] for group in groups]
    picture = look.at(feature.pitch)
    return transform(picture, look.gains, look.mean, rows, feature.box, feature.pitch)


def brow_field(field: Field, corner: Array, rest: Array, eye: Array) -> Field:
    """``field`` of a brow without the eye (6, 2) below it and the hair round it; ``rest`` (6, 2)
    says where the brow is expected."""
    middle = (rest.mean(axis=0) - corner) / COARSE
    return np.asarray(without_hair(above(field, eye, corner), middle))
