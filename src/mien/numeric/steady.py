"""Smoothing by a running parabola over as long a window as the signal allows.

A parabola follows any steady acceleration, so that peaks keep their height where a running mean
would lower them. Which window errs least is told by Stein's unbiased estimate of the risk: what is
taken away, and twice the noise that every value keeps of itself. (Savitzky and Golay 1964; Stein
1981.)
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.signal import savgol_coeffs, savgol_filter

from mien.numeric.noise import noise_of

Array = NDArray[np.float64]

_WINDOWS = (0.03, 0.05, 0.07, 0.1, 0.14, 0.2, 0.3, 0.5, 0.8, 1.3, 2.0)
"""Seconds to choose from."""


def steady(signal: Array, rate: float) -> tuple[Array, float]:
    """``signal`` (F, ...) at ``rate`` frames a second without its noise, as far as that is wise,
    and the part of white noise that is left in it (1 where it was left alone)."""
    noise = noise_of(signal)
    best, left, least = signal, 1.0, 2.0 * noise**2
    for seconds in _WINDOWS:
        window = 2 * round(seconds * rate / 2.0) + 1
        if not 5 <= window <= len(signal):
            continue
        smoothed = savgol_filter(signal, window, 2, axis=0)
        own = float(savgol_coeffs(window, 2)[window // 2])
        risk = float(((signal - smoothed) ** 2).mean()) + 2.0 * own * noise**2
        if risk < least:
            best, left, least = smoothed, np.sqrt(own), risk
    return best, left
