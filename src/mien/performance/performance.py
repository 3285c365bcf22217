"""A performance: what a performer's face did, free of any character and of how it was seen."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_PER_FRAME = (
    "time",
    "motion",
    "rotation",
    "translation",
    "gaze",
    "confidence",
    "lost",
    "unseen",
)


@dataclass(frozen=True, slots=True)
class Span:
    """A distance between two feature points that is known better than either point alone
    (lip opening, mouth width): the pair's difference of motion has its own standard error."""

    first: str
    second: str
    axis: int
    """Head-frame axis along which the difference is measured: 0 x, 1 y, 2 z."""
    sigma: float
    """mm."""


@dataclass(frozen=True, slots=True)
class Performance:
    """F frames of P feature points of one performer.

    Head frame: origin midway between the eyeball centres, +x to the performer's left, +y up,
    +z out of the face; mm. World: the same axes as seen by a viewer in front (+x to the picture's
    right, +y up, +z towards the camera). Angles in radians.
    """

    points: tuple[str, ...]
    """(P) FDP ids."""
    neutral: Array
    """(P, 3) the performer's own neutral."""
    time: Array
    """(F,) seconds."""
    motion: Array
    """(F, P, 3) displacement from neutral in the head frame."""
    sigma: Array
    """(P, 3) standard error of each coordinate of ``motion``."""
    rotation: Array
    """(F, 3, 3) world_from_head."""
    translation: Array
    """(F, 3) the head's origin in the world, mm."""
    gaze: Array
    """(F, 2, 2) left, right eye; yaw (+ to the performer's left) and pitch (+ up), relative to
    the head and to the gaze at neutral."""
    confidence: Array
    """(F,) 0..1."""
    lost: NDArray[np.bool_]
    """(F,) no face was seen; the other fields repeat the last frame that had one."""
    unseen: Array
    """(F, 3) unit direction in the head frame along which nothing was measured; zero: none."""
    rest_rotation: Array = field(default_factory=lambda: np.eye(3))
    """(3, 3) world_from_head at neutral: what a character's straight look stands for."""
    rest_translation: Array = field(default_factory=lambda: np.zeros(3))
    """(3,)"""
    spans: tuple[Span, ...] = ()
    scalars: Mapping[str, Array] = field(default_factory=dict)
    """(F,) each. "lid_left", "lid_right": closure, 0 the performer's own open, 1 shut;
    "tongue_out", "cheek_puff": 0..1. Absent means not measured."""
    vocabulary: str = ""
    """Name of the vocabulary ``shapes`` speaks ("arkit"), or empty."""
    shapes: Array = field(default_factory=lambda: np.zeros((0, 0)))
    """(F, K) weights under that vocabulary, or (0, 0)."""
    source: str = ""
    """Where it came from, for a person to read."""
    faces: int = 1
    """The most faces that were in view; one of them was followed."""

    def __len__(self) -> int:
        return len(self.time)

    def __getitem__(self, part: slice) -> Performance:
        """The frames of ``part``, at their own times."""
        each = {name: getattr(self, name)[part] for name in _PER_FRAME}
        return replace(
            self,
            **each,
            scalars={name: values[part] for name, values in self.scalars.items()},
            shapes=self.shapes[part],
        )

    def head(self) -> tuple[Array, Array]:
        """Head rotation (F, 3, 3) and translation (F, 3) relative to the neutral pose: what a
        character looking straight ahead has to do."""
        return (
            np.einsum("ji,fjk->fik", self.rest_rotation, self.rotation),
            (self.translation - self.rest_translation) @ self.rest_rotation,
        )
