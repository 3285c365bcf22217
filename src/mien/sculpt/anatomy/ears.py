"""Ears: a polar relief with rim, antihelix and bowl, sunk into the head at its root."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.sculpt.colour import Colour, linear
from mien.sculpt.solid import Solid, dome, sheet

Array = NDArray[np.float64]

_ROWS, _AROUND = 9, 28


@dataclass(frozen=True, slots=True)
class EarShape:
    """Half height and width, place of the front edge, degrees of tilt and of flare."""

    height: float = 28.0
    width: float = 16.0
    root: tuple[float, float, float] = (70.0, 11.0, -31.0)
    tilt: float = 12.0
    flare: float = 28.0
    round: bool = False
    """An ape's: one rim round a shallow bowl."""


def ear(shape: EarShape, skin: Colour, bowl: Colour) -> Solid:
    """The left ear."""
    angle = np.linspace(0, 2 * np.pi, _AROUND, endpoint=False)[None]
    reach = (np.linspace(0, 1, _ROWS + 1)[1:, None]) ** 0.9
    front, shade = _relief(shape, reach, angle)
    back = -2.2 - 3.5 * np.exp(-((reach / 0.6) ** 2)) + 0 * angle
    # Both sheets close at the rim.
    thin = np.where(reach > 0.97, 0.25, 1.0)
    x, y = _outline(shape, reach, angle)
    pole_front, pole_shade = _relief(shape, np.zeros((1, 1)), angle)
    above = dome((0, 0, pole_front[0, 0]), np.stack([x, y, front * thin], axis=-1))
    below = dome((0, 0, -5.7), np.stack([x, y, back * thin], axis=-1))
    count = len(above[0])
    rim = count - _AROUND + np.arange(_AROUND)
    band = np.concatenate([rim, rim + count])[sheet(2, _AROUND)]
    triangles = np.concatenate([above[1], below[1][:, ::-1] + count, band])
    vertices = np.concatenate([above[0], below[0]])
    vertices[:, 0] += 0.8 * shape.width
    hollow = np.concatenate([[pole_shade[0, 0]], shade.ravel(), np.zeros(len(below[0]))])[:, None]
    colours = linear(skin) * (1 - hollow) + linear(bowl) * hollow
    return Solid("ear_left", "skin", _hung(vertices, shape), triangles, colours)


def _outline(shape: EarShape, reach: Array, angle: Array) -> tuple[Array, Array]:
    cosine, sine = np.cos(angle), np.sin(angle)
    width = shape.width * np.ones_like(angle)
    if not shape.round:
        width = shape.width * (1 + 0.10 * sine - 0.12 * (cosine < 0) * np.abs(cosine))
        width = width * (1 - 0.34 * np.clip(-sine, 0, 1) ** 2)
    return reach * width * cosine, reach * shape.height * sine


def _relief(shape: EarShape, reach: Array, angle: Array) -> tuple[Array, Array]:
    """Height of the front and depth of colour, (rows, around) each."""
    if shape.round:
        rim = np.exp(-(((reach - 0.88) / 0.10) ** 2)) + 0 * angle
        bowl = np.exp(-((reach / 0.72) ** 4)) + 0 * angle
        return 2.2 + 3.4 * rim - 3.2 * bowl, 0.55 * bowl
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y = _outline(shape, reach, angle)
    lobe = np.clip((-sine - 0.55) / 0.35, 0, 1)
    rim = np.exp(-(((reach - 0.90) / 0.10) ** 2)) * (1 - 0.75 * lobe)
    rim = rim * np.clip((cosine + 1.0) / 0.45, 0.15, 1)
    behind = np.clip((cosine + 0.55) / 0.8, 0, 1)
    antihelix = np.exp(-(((reach - 0.60) / 0.12) ** 2)) * behind * (1 - lobe)
    across = ((x + 0.10 * shape.width) / (0.44 * shape.width)) ** 2
    up = ((y + 0.02 * shape.height) / (0.36 * shape.height)) ** 2
    bowl = np.exp(-((across + up) ** 1.6))
    return 2.2 + 3.4 * rim + 2.4 * antihelix - 6.0 * bowl, 0.55 * bowl


def _hung(vertices: Array, shape: EarShape) -> Array:
    """From the ear's plane (x backwards, y up, z outwards) to the head's left side."""
    tilt, flare = np.radians(-shape.tilt), np.radians(shape.flare)
    x = vertices[:, 0] * np.cos(tilt) - vertices[:, 1] * np.sin(tilt)
    y = vertices[:, 0] * np.sin(tilt) + vertices[:, 1] * np.cos(tilt)
    z = vertices[:, 2]
    outward = x * np.sin(flare) + z * np.cos(flare)
    ahead = z * np.sin(flare) - x * np.cos(flare)
    return np.stack([outward, y, ahead], axis=1) + shape.root
