"""A film of a take: the performer beside the characters that act it."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from mien.face.animate import Poser
from mien.face.character import Character
from mien.face.targets import targets
from mien.performance.curves import Curves
from mien.performance.frame import Frame
from mien.view.camera import Camera
from mien.view.framing import framing
from mien.view.renderer import Renderer

Picture = NDArray[np.uint8]

CAMERA = Camera(height=305.0, centre=(0.0, -8.0, -55.0))
_SIDE = 360
"""Pixels of a character's square."""
_ALONE = 540
"""The same where there is only one."""
_AHEAD = 4
"""Frames that wait at most: memory does not grow with the take."""
_WIDEST = 2.4
"""Width over height of the performer's picture, at most."""
_CURTAIN = 24
"""Grey behind what does not fill its cell."""


def preview(
    acts: Sequence[tuple[Character, Curves]],
    performer: Iterable[Frame] | None = None,
    threads: int = 2,
) -> Iterator[Frame]:
    """Frames of the film, one for each frame of the curves, at their times.

    ``acts``: up to four characters and what they do, over the same frames. ``performer``: the
    take's own pictures, frame for frame; without them the characters are alone.
    """
    actors = [_Actor(character, curves, _side(len(acts))) for character, curves in acts]
    times = acts[0][1].time
    height = _side(len(acts)) * _rows(len(acts))
    shown: Iterable[Frame | None] = [None] * len(times) if performer is None else performer
    waiting: deque[tuple[float, list[Future[Picture]]]] = deque()
    with ThreadPoolExecutor(threads) as pool:
        for frame, (time, seen) in enumerate(zip(times, shown, strict=False)):
            drawn = [pool.submit(actor.draw, frame) for actor in actors]
            if seen is not None:
                drawn.append(pool.submit(_scaled, seen.image, height))
            waiting.append((float(time), drawn))
            if len(waiting) > _AHEAD:
                yield _composed(*waiting.popleft(), len(actors))
        while waiting:
            yield _composed(*waiting.popleft(), len(actors))


class _Actor:
    """A character on its stage."""

    def __init__(self, character: Character, curves: Curves, side: int) -> None:
        self._curves = curves
        self._poser = Poser(character.face, targets(character, curves.names))
        self._renderer = Renderer(character.face)
        camera = framing(character.face) if character.whole else CAMERA
        self._camera = replace(camera, size=(side, side))

    def draw(self, frame: int) -> Picture:
        return self._renderer.render(self._poser.at(self._curves, frame), self._camera)


def _side(count: int) -> int:
    return _ALONE if count == 1 else _SIDE


def _rows(count: int) -> int:
    return 1 if count == 1 else 2


def _scaled(image: Picture, height: int) -> Picture:
    """The performer at the height of the film; a very wide picture lies between curtains."""
    picture = Image.fromarray(image)
    scale = min(height / picture.height, _WIDEST * height / picture.width)
    size = (max(1, round(picture.width * scale)), max(1, round(picture.height * scale)))
    shown = np.asarray(picture.resize(size, Image.Resampling.BILINEAR, reducing_gap=2.0))
    film = np.full((height, size[0], 3), _CURTAIN, dtype=np.uint8)
    top = (height - size[1]) // 2
    film[top : top + size[1]] = shown
    return film


def _composed(time: float, drawn: list[Future[Picture]], actors: int) -> Frame:
    """One picture of the film: the performer, then the characters in two rows."""
    pictures = [future.result() for future in drawn]
    stage, performer = pictures[:actors], pictures[actors:]
    rows = _rows(actors)
    stage += [np.full_like(stage[0], _CURTAIN)] * (-actors % rows)
    columns = len(stage) // rows
    lines = [np.hstack(stage[row * columns : (row + 1) * columns]) for row in range(rows)]
    return Frame(np.hstack([*performer, np.vstack(lines)]), time)
