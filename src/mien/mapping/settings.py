"""How a performance is mapped."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mien.errors import InputError
from mien.mapping.own import OwnExamples
from mien.mapping.ranges import Ranges


@dataclass(frozen=True, slots=True)
class Settings:
    """Ridges and pulls are in units of the noise's variance, thrift in its standard errors."""

    examples: str = "character"
    """Source examples: "character" (measured on itself) or "generic" (of the same names)."""
    gain: float = 1.0
    """Exaggeration: the motion is multiplied by it before it is mapped."""
    coupling: float = 2.0
    """Pull to the cardinal weights; 0 for bounded least squares."""
    ridge: float = 0.3
    """Pull to rest."""
    thrift: float = 0.6
    """Standard errors by which a piece must show before it moves at all. Weights cannot be
    negative, so noise does not cancel: without this many small wrong pieces pile up."""
    balance: float = 15.0
    """Pull of the left and right piece of a key model to each other."""
    kinship: float = 10.0
    """Pull of the pieces of a key model in all regions to each other: it decides what one region
    alone cannot tell (the brows of fear are half the brows of surprise)."""
    linear_ridge: float = 5.0
    """Ridge of the cardinal functions' linear part."""
    brows: float = 1.0
    eyes: float = 1.0
    mouth: float = 1.0
    head: float = 1.0
    """Exaggeration of each region, beside ``gain``; lids and gaze go with the eyes."""
    own: OwnExamples | None = None
    """Moments of the performer that stand for poses of the character."""
    ranges: Ranges | None = None
    """The performer's own range, which is made the character's."""
    bound: float = 1.15
    """Largest weight, at a gain of 1 or less."""

    def __post_init__(self) -> None:
        for name in ("gain", "brows", "eyes", "mouth", "head"):
            level = getattr(self, name)
            if not (np.isfinite(level) and 0.0 <= level <= 10.0):
                raise InputError(f"{name} {level} cannot be used; choose from 0 to 10")

    @property
    def largest(self) -> float:
        """Largest weight: an exaggerated face may go further."""
        return self.bound * max(self.gain * max(self.brows, self.eyes, self.mouth), 1.0)
