"""One picture of a recording."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray


@dataclass(frozen=True, slots=True)
class Frame:
    """A picture and when it was taken."""

    image: NDArray[np.uint8]
    """(H, W, 3) RGB, upright, square pixels."""
    time: float
    """Seconds from the start of the take, as the file tells."""
