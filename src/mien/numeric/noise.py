"""How noisy a signal is, told from the signal."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Standard deviation of a third difference of white noise: the root of 1 + 9 + 9 + 1; and what
# takes a median of absolute values of a normal distribution to its standard deviation.
_GAIN = np.sqrt(20.0) * 0.6745


def noise_of(signal: Array) -> float:
    """Standard deviation of the white noise on ``signal`` (F, ...), NaN where unknown; 0 where it
    is too short to tell. Smooth motion hardly shows in third differences over neighbouring
    frames, and their median forgets leaps."""
    change = np.abs(np.diff(signal, n=3, axis=0))
    known = change[np.isfinite(change)]
    return float(np.median(known) / _GAIN) if len(known) else 0.0
