"""What is known of a face before and after a frame is looked at."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.colour.transform import Weights
from mien.capture.snakes.curves.fields import Look
from mien.capture.snakes.head.patch import Picture, Placement
from mien.capture.snakes.head.pose import Pose
from mien.capture.snakes.iris import Irises
from mien.capture.snakes.mouth import LipColour, Opening
from mien.capture.snakes.tongue import Tongue

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Seen:
    """What the snakes found in one frame."""

    placement: Placement
    pose: Pose
    lenses: Array
    """(L + 1, 6, 2) features and the mouth's opening, patch units."""
    rigid: Array
    """(COUNT, 2) points of nose and inner eyes, patch units."""
    lost: Bools
    """(L,) features that were not found; their lenses are the last ones that were, or, of lips,
    doubtful ones."""
    contrast: Array
    """(L,) mean I just inside the curves minus just outside."""
    opening: Opening
    tongue: Tongue | None
    """None before a mouth was seen."""
    irises: Irises
    apertures: Array
    """(2,) how tall the right and the left eye stand open in this frame alone, patch units."""
    look: Look
    weights: Mapping[str, Weights]
    grey: Picture
    lips: LipColour
    glow: float
    """How much of I is taken from lips and the skin round them."""
    recovered: bool = False
    """The face had to be found anew."""


@dataclass(frozen=True, slots=True)
class Start:
    """Where the search in a frame begins."""

    placement: Placement
    pose: Pose
    lenses: Array
    rigid: Array
