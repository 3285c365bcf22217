"""Curves: what one character does over time. The only thing that travels live."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Curves:
    """F frames of the weights of a character's morph targets, its head and its eyes."""

    character: str
    names: tuple[str, ...]
    """(W) morph targets, as the character's file has them."""
    time: Array
    """(F,) seconds."""
    weights: Array
    """(F, W)"""
    rotation: Array
    """(F, 3, 3) of the head about its pivot, from its straight look."""
    translation: Array
    """(F, 3) mm, of the whole character."""
    gaze: Array
    """(F, 2, 2) left, right eye; yaw (+ to the subject's left), pitch (+ up), radians."""
    lost: NDArray[np.bool_]
    """(F,) frames in which the performer was not seen."""
    residual: Array
    """(F,) mm, root mean square motion that no key model expressed."""

    def __len__(self) -> int:
        return len(self.time)
