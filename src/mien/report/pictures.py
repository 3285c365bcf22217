"""Small pictures of a take and of the characters that act it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageOps

from mien.face.animate import Poser
from mien.face.character import Character
from mien.face.targets import targets
from mien.formats.pictures.sources import open_source
from mien.performance.curves import Curves
from mien.view.camera import Camera
from mien.view.framing import framing
from mien.view.preview import CAMERA
from mien.view.renderer import Renderer

Picture = NDArray[np.uint8]

_EARLY = 1e-3
"""Seconds by which a search begins before the frame that is wanted: times are rounded."""


def of_take(
    path: str | Path,
    seconds: Sequence[float],
    side: int,
    *,
    start: float | None = None,
    mirror: bool = False,
    rate: float | None = None,
) -> list[Picture]:
    """Square pictures (side, side, 3) of a recording at ``seconds`` from ``start``, its middle
    where it is not square. Raises InputError, FormatError."""
    begin = start or 0.0
    return [
        _square(next(iter(open_source(path, _at(begin + when), None, mirror, rate))).image, side)
        for when in seconds
    ]


def of_character(
    character: Character, curves: Curves, frames: Sequence[int], side: int
) -> Iterator[Picture]:
    """Square pictures (side, side, 3) of ``character`` at ``frames`` of its ``curves``."""
    poser = Poser(character.face, targets(character, curves.names))
    renderer = Renderer(character.face)
    camera = camera_on(character, side)
    for frame in frames:
        yield renderer.render(poser.at(curves, frame), camera)


def camera_on(character: Character, side: int) -> Camera:
    """Where films are taken from."""
    camera = framing(character.face) if character.whole else CAMERA
    return replace(camera, size=(side, side))


def _at(seconds: float) -> float:
    return max(0.0, seconds - _EARLY)


def _square(image: Picture, side: int) -> Picture:
    picture = Image.fromarray(image)
    fitted = ImageOps.fit(picture, (side, side), Image.Resampling.LANCZOS, centering=(0.5, 0.4))
    return np.asarray(fitted)


def of_key(character: Character, name: str, side: int) -> Picture:
    """A square picture of one of ``character``'s key models in full. Raises KeyError."""
    weights = np.zeros(len(character.keys.names))
    weights[character.keys.names.index(name)] = 1.0
    surface = character.surface(weights)
    return Renderer(character.face).render(surface, camera_on(character, side))
