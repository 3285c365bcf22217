"""A face with its feature points marked and numbered, from the front and from three quarters."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from mien.face.character import Character
from mien.view.camera import Camera
from mien.view.renderer import Renderer

_SIDE = 900
_DOT = 3
_MARK, _TEXT = (220, 30, 30), (20, 30, 110)


def points_sheet(character: Character) -> NDArray[np.uint8]:
    """Picture (900, 1800, 3)."""
    face = character.face
    places = face.points.at(face.vertices)
    renderer, font = Renderer(face), ImageFont.load_default(14)
    height = 1.6 * max(float(np.ptp(places[:, 1])), float(np.ptp(places[:, 0])))
    views = []
    for yaw in (0.0, 0.7):
        camera = Camera(
            yaw=yaw,
            height=height,
            centre=tuple(places.mean(axis=0).tolist()),
            size=(_SIDE, _SIDE),
            distance=4.0 * height,
        )
        picture = Image.fromarray(renderer.render(face.vertices, camera))
        draw = ImageDraw.Draw(picture)
        for fdp, (x, y, _) in zip(face.points.ids, camera.project(places).tolist(), strict=True):
            draw.ellipse((x - _DOT, y - _DOT, x + _DOT, y + _DOT), fill=_MARK)
            draw.text((x + _DOT + 1, y - 8), fdp, _TEXT, font)
        views.append(np.asarray(picture))
    return np.hstack(views)
