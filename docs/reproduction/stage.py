"""Performers of our own: characters filmed while they act, so that what they did is known."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from time import process_time

import numpy as np
from numpy.typing import NDArray

import mien
from mien.capture import CAPTURES, CaptureSettings
from mien.face.animate import Poser
from mien.face.character import Character
from mien.face.targets import targets
from mien.performance.curves import Curves
from mien.performance.frame import Frame
from mien.performance.performance import Performance
from mien.performance.trace import Trace
from mien.rehearsal import Tempo, film, held, rehearse
from mien.view.camera import Camera
from mien.view.renderer import Renderer

Picture = NDArray[np.uint8]
Array = NDArray[np.float64]

_WARM, _TIMED = 20, 240
"""Frames."""


@dataclass(frozen=True)
class Shot:
    """A film kept in memory, and what was acted in it."""

    character: Character
    acted: Curves
    frames: list[Frame]

    def captured(self, method: str) -> tuple[Performance, list[Trace]]:
        """What a capture makes of it, and what it saw in every frame."""
        traces: list[Trace] = []
        settings = CaptureSettings(watch=traces.append)
        return CAPTURES[method](self.frames, settings, self.character.name), traces

    def speed(self, method: str) -> float:
        """Frames a second of a capture by the processor's own clock, once it is warm."""
        way, name = CAPTURES[method], self.character.name
        way(self.frames[:_WARM], CaptureSettings(), name)
        frames = self.frames[:_TIMED]
        begin = process_time()
        way(frames, CaptureSettings(), name)
        return len(frames) / (process_time() - begin)

    def middle(self, key: str) -> int:
        """The frame in the middle of where ``key`` is held."""
        return int(np.median(held(self.acted, key)))


def shoot(
    name: str,
    keys: Sequence[str] | None = None,
    tempo: Tempo | None = None,
    frames: int | None = None,
    camera: Camera | None = None,
) -> Shot:
    """Film the character called ``name``, at most ``frames`` frames of it."""
    character = mien.load_character(name)
    acted = rehearse(character, keys, tempo)
    acted = first(acted, frames or len(acted))
    return Shot(character, acted, list(film(character, acted, camera)))


def first(curves: Curves, frames: int) -> Curves:
    """The first ``frames`` frames of ``curves``."""
    fields = ("time", "weights", "rotation", "translation", "gaze", "lost", "residual")
    return replace(curves, **{name: getattr(curves, name)[:frames] for name in fields})


def portraits(
    character: Character, curves: Curves, frames: Sequence[int], camera: Camera | None = None
) -> Iterator[Picture]:
    """What ``character`` looks like in some ``frames`` of ``curves``."""
    poser = Poser(character.face, targets(character, curves.names))
    renderer, camera = Renderer(character.face), camera or Camera(size=(300, 300))
    for frame in frames:
        yield renderer.render(poser.at(curves, frame), camera)


def sculpted(character: Character, key: str, size: int = 150) -> Picture:
    """A key model as its sculptor left it."""
    poser = Poser(character.face, character.keys)
    weights = (np.array(character.keys.names) == key).astype(float)
    return Renderer(character.face).render(poser.morph(weights), Camera(size=(size, size)))
