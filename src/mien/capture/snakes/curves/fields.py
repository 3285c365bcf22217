"""The transformed pictures in which features are sought: one field for each rectangle."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

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
from mien.capture.snakes.head.patch import ORIGIN, Picture

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Look:
    """A patch and what all its transformations share."""

    patch: Picture
    gains: Array
    """(3,) factors that make its skin USUAL_SKIN."""
    value: Field
    """(H, W) brightness after scaling."""
    mean: Field
    """(H, W) the neighbourhood's."""


Weigh = Callable[[Look, Array], Mapping[str, Weights]]
"""Weights of each group for a look and the lenses (L, 6, 2) expected in it."""


def usual_weights(look: Look, lenses: Array) -> Mapping[str, Weights]:
    """Those that serve most people."""
    return USUAL_WEIGHTS


def look_at(patch: Picture, skin: Array | None = None) -> Look:
    """``patch`` scaled by its own skin, or by a ``skin`` (3,) known from elsewhere."""
    factors = gains(skin_colour(patch) if skin is None else skin)
    value = brightness(patch, factors)
    return Look(patch, factors, value, neighbourhood(value))


def corner_of(feature: Feature) -> Array:
    """(2,) patch units of the first pixel of a feature's rectangle."""
    left, top, _, _ = window(feature.box)
    return np.asarray(np.array([left, top]) - ORIGIN, dtype=float)


def field_of(look: Look, feature: Feature, weights: Mapping[str, Weights]) -> Field:
    """I of a feature's rectangle. An eye is what is dark or what is white."""

    def seen(group: str) -> Field:
        return transform(look.patch, look.gains, look.value, look.mean, weights[group], feature.box)

    if feature.group == "eye":
        return np.asarray(np.maximum(seen("eye"), seen("sclera")), dtype=np.float32)
    return seen(feature.group)


def brow_field(field: Field, corner: Array, rest: Array, eye: Array) -> Field:
    """``field`` of a brow without the eye (6, 2) below it and the hair round it; ``rest`` (6, 2)
    says where the brow is expected."""
    return np.asarray(without_hair(above(field, eye, corner), rest.mean(axis=0) - corner))
