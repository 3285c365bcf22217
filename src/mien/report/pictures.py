"""Small pictures of a take and of the characters that act it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from mien.capture.landmarks import USUAL_FOCAL
from mien.face.animate import Poser
from mien.face.character import Character
from mien.face.targets import targets
from mien.formats.markers.file import holds_markers
from mien.formats.pictures.sources import open_source
from mien.performance.curves import Curves
from mien.performance.performance import Performance
from mien.recipe import READERS
from mien.view.camera import Camera
from mien.view.framing import framing
from mien.view.preview import CAMERA
from mien.view.renderer import Renderer

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]

_EARLY = 1e-3
"""Seconds by which a search begins before the frame that is wanted: times are rounded."""


def has_pictures(take: str | Path) -> bool:
    """Whether a take is a recording that can be looked at once more."""
    captured = Path(take).suffix.lower() in READERS or holds_markers(take)
    return not captured and not str(take).startswith("camera:")


def of_take(
    path: str | Path,
    performance: Performance,
    frames: Sequence[int],
    side: int,
    *,
    start: float | None = None,
    mirror: bool = False,
    rate: float | None = None,
    focal: float | None = None,
) -> list[Picture]:
    """Square pictures (side, side, 3) of the face in a recording at ``frames`` of the
    ``performance`` captured from it, framed as characters are; ``start``, ``mirror``, ``rate`` and
    ``focal`` as it was captured. Raises InputError, FormatError."""
    shown = []
    for frame in frames:
        begin = max(0.0, (start or 0.0) + float(performance.time[frame]) - _EARLY)
        image = next(iter(open_source(path, begin, None, mirror, rate))).image
        pixels = focal or USUAL_FOCAL * image.shape[1]
        shown.append(_face(image, performance.translation[frame], pixels, side))
    return shown


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


def of_key(character: Character, name: str, side: int) -> Picture:
    """A square picture of one of ``character``'s key models in full. Raises KeyError."""
    weights = np.zeros(len(character.keys.names))
    weights[character.keys.names.index(name)] = 1.0
    camera = camera_on(character, side)
    if not character.whole:
        camera = replace(camera, yaw=-0.25, height=200.0, centre=(0.0, -20.0, -20.0))
    return Renderer(character.face).render(character.surface(weights), camera)


def _face(image: Picture, head: Array, focal: float, side: int) -> Picture:
    """The square of ``image`` round a head at ``head`` (3,) mm, as far as the picture goes."""
    height, width = image.shape[:2]
    pixels = focal / -head[2] if head[2] < 0.0 else np.inf
    reach = min(CAMERA.height * pixels, width, height)
    x, y = width / 2.0, height / 2.0
    if np.isfinite(pixels):
        x += pixels * head[0]
        y -= pixels * (head[1] + CAMERA.centre[1])
    left = min(max(x - reach / 2.0, 0.0), width - reach)
    top = min(max(y - reach / 2.0, 0.0), height - reach)
    picture = Image.fromarray(image)
    box = (left, top, left + reach, top + reach)
    return np.asarray(picture.resize((side, side), Image.Resampling.LANCZOS, box=box))
