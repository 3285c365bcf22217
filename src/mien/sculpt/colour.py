"""Painting: colours are named as a painter picks them (sRGB) and mixed in linear light."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mien.sculpt.anatomy.head import Head
from mien.sculpt.anatomy.skin import labels
from mien.sculpt.brush import bump
from mien.sculpt.proportions import Triple
from mien.vocabulary import topology

Array = NDArray[np.float64]
Colour = tuple[float, float, float]


def linear(colour: ArrayLike) -> Array:
    """Linear RGB of an sRGB ``colour`` (..., 3)."""
    value = np.asarray(colour, dtype=float)
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def mix(under: Array, colour: Colour, amount: ArrayLike) -> Array:
    """``under`` (V, 3) glazed with ``colour``, by ``amount`` (V,) or a number."""
    share = np.reshape(np.asarray(amount, dtype=float), (-1, 1))
    return np.asarray(under * (1 - share) + linear(colour) * share)


def paint_mouth(colours: Array, head: Head, deep: Colour = (0.34, 0.06, 0.07)) -> Array:
    """Rose at the lips, darker behind, never black: it is lit through."""
    bag = labels().bag
    colours = mix(colours, (0.66, 0.20, 0.20), np.clip(2.2 * bag - 0.1, 0, 1))
    behind = np.clip((head.proportions.mouth.depth - 16 - head.skin[:, 2]) / 26, 0, 1)
    return mix(colours, deep, behind * np.clip(2 * bag, 0, 1))


def paint_lips(colours: Array, colour: Colour, amount: float = 1.0) -> Array:
    """Paint that ends at the vermilion border."""
    return mix(colours, colour, amount * np.clip((labels().lips - 0.74) / 0.16, 0, 1))


def paint_lid_edges(colours: Array, colour: Colour) -> Array:
    """The wet edge between lid and ball."""
    return mix(colours, colour, 0.8 * np.clip(1.6 * labels().lid_inside, 0, 1))


def paint_nostrils(colours: Array, head: Head, radii: Triple, colour: Colour, most: float) -> Array:
    """Darkness in the nostrils."""
    middle = head.cage[topology.NOSTRIL].mean(axis=0)
    return mix(colours, colour, np.clip(1.3 * bump(head.skin, middle, radii), 0, most))


def paint_skin(
    head: Head,
    base: Colour,
    blush: Colour,
    lips: Colour,
    lids: Colour | None = None,
    blush_amount: float = 0.5,
    lip_amount: float = 1.0,
) -> Array:
    """A human skin: ``base`` with ``blush`` on cheeks, nose, ears and lids."""
    skin, eye = head.skin, head.proportions.eye
    colours = np.tile(linear(base), (len(skin), 1))
    for centre, radii, amount in (
        ((eye.aside + 10, eye.height - 38, 36), (20, 15, 30), 0.35),
        ((0, -2, 72), (13, 12, 14), 0.30),
        ((74, 0, -35), (12, 30, 20), 0.22),
    ):
        colours = mix(colours, blush, amount * blush_amount * bump(skin, centre, radii))
    colours = mix(colours, lids or blush, 0.28 * labels().eye_area)
    colours = paint_lips(colours, lips, lip_amount)
    colours = paint_mouth(colours, head)
    colours = paint_lid_edges(colours, (0.80, 0.42, 0.38))
    return paint_nostrils(colours, head, (3.0, 2.2, 4.5), (0.30, 0.10, 0.08), 0.85)
