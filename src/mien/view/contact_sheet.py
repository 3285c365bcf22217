"""Everything a character can do, on one sheet."""

from __future__ import annotations

from dataclasses import replace
from math import pi

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from mien.face.animate import Poser
from mien.face.character import Character
from mien.view.camera import Camera
from mien.view.framing import framing
from mien.view.renderer import Renderer

Picture = NDArray[np.uint8]

_WIDTH = 1600
_MARGIN = 2
_PAPER = (38, 42, 48)
_VIEWS = {"front": 0.0, "three quarters": 0.7, "side": pi / 2, "back": pi}
_WHOLE = Camera(pitch=0.05, height=310.0)
_CLOSE = Camera(yaw=-0.28, pitch=0.035, height=215.0, centre=(0.0, -22.0, -20.0))
_COLUMNS = 5


def contact_sheet(character: Character) -> Picture:
    """Picture (H, 1600, 3) of the neutral from four sides and of every key model, labelled."""
    poser, renderer = Poser(character.face, character.keys), Renderer(character.face)
    rest = character.face.vertices
    whole, close = _WHOLE, _CLOSE
    if character.whole:
        whole = close = framing(character.face)
    views = {
        f"{character.name}, {name}": renderer.render(rest, _sized(whole, len(_VIEWS), yaw=yaw))
        for name, yaw in _VIEWS.items()
    }
    keys = {
        name: renderer.render(poser.morph(weights), _sized(close, _COLUMNS))
        for name, weights in zip(poser.names, np.eye(len(poser.names)), strict=True)
    }
    return np.vstack([_grid(views, len(_VIEWS)), _grid(keys, _COLUMNS)])


def _sized(camera: Camera, columns: int, yaw: float | None = None) -> Camera:
    side = _WIDTH // columns - 2 * _MARGIN
    return replace(camera, size=(side, side), yaw=camera.yaw if yaw is None else yaw)


def _grid(cells: dict[str, Picture], columns: int) -> Picture:
    cell = _WIDTH // columns
    rows = -(-len(cells) // columns)
    sheet = Image.new("RGB", (_WIDTH, rows * cell), _PAPER)
    draw = ImageDraw.Draw(sheet)
    font = ImageFont.load_default(cell / 17)
    for index, (label, picture) in enumerate(cells.items()):
        x, y = index % columns * cell, index // columns * cell
        sheet.paste(Image.fromarray(picture), (x + _MARGIN, y + _MARGIN))
        draw.text((x + 12, y + 9), label, "white", font, stroke_width=2, stroke_fill=(20, 24, 30))
    return np.asarray(sheet)
