"""A rehearsal: a character acts its key models one after another before a virtual camera.

What was acted is known, so a rehearsal shows how much of a performance survives being filmed,
captured and mapped back. It is also the take that ``mien demo`` ships.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.face.animate import Poser
from mien.face.character import Character
from mien.numeric.rotation import from_vector
from mien.performance.curves import Curves
from mien.performance.frame import Frame
from mien.view.camera import Camera
from mien.view.renderer import Renderer

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Tempo:
    """Seconds a key model takes, and how the head sways meanwhile."""

    rest: float = 0.6
    """Neutral before the first key model and after the last."""
    rise: float = 0.2
    hold: float = 0.4
    gap: float = 0.15
    rate: float = 30.0
    """Frames a second."""
    sway: float = 0.12
    """Radians the head turns to either side."""


def rehearse(
    character: Character, keys: Sequence[str] | None = None, tempo: Tempo | None = None
) -> Curves:
    """Curves over the character's whole key models: each of ``keys`` (its examples) rises, is held
    at 1 and falls, while the head sways. Raises KeyError for a key model it has not."""
    keys, tempo = keys or character.examples, tempo or Tempo()
    step = 2 * tempo.rise + tempo.hold + tempo.gap
    starts = tempo.rest + step * np.arange(len(keys))
    time = np.arange(0.0, 2 * tempo.rest + step * len(keys), 1.0 / tempo.rate)
    weights = np.zeros((len(time), len(character.keys.names)))
    for key, start in zip(keys, starts, strict=True):
        character.keys[key]
        level = np.minimum(time - start, start + 2 * tempo.rise + tempo.hold - time) / tempo.rise
        weights[:, character.keys.names.index(key)] = _ease(level)
    awake = _ease((time - tempo.rest) / tempo.rest)
    turn = tempo.sway * awake * np.sin(2.1 * (time - tempo.rest))
    nod = 0.5 * tempo.sway * awake * np.sin(1.3 * (time - tempo.rest))
    return Curves(
        character=character.name,
        names=character.keys.names,
        time=time,
        weights=weights,
        rotation=from_vector(np.stack([nod, turn, np.zeros_like(time)], axis=1)),
        translation=np.zeros((len(time), 3)),
        gaze=np.zeros((len(time), 2, 2)),
        lost=np.zeros(len(time), dtype=bool),
        residual=np.zeros(len(time)),
    )


def held(curves: Curves, key: str) -> NDArray[np.intp]:
    """Frames in which ``key`` is acted in full."""
    return np.flatnonzero(curves.weights[:, curves.names.index(key)] > 0.999)


def film(character: Character, curves: Curves, camera: Camera | None = None) -> Iterator[Frame]:
    """Pictures of ``character`` acting ``curves`` over its whole key models."""
    poser = Poser(character.face, character.keys)
    renderer = Renderer(character.face)
    camera = camera or Camera(size=(480, 480))
    for frame, time in enumerate(curves.time.tolist()):
        yield Frame(renderer.render(poser.at(curves, frame), camera), time)


def _ease(level: Array) -> Array:
    """0 below 0, 1 above 1, smooth between."""
    level = np.clip(level, 0.0, 1.0)
    return level * level * (3.0 - 2.0 * level)
