"""The uniform cubic B-spline as a radial profile."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def cubic(distance: Array) -> Array:
    """B(t) at ``distance`` t >= 0 from its centre, knots one apart: 2/3 at 0, 1/6 at 1, zero and
    twice smooth from 2 on."""
    near = np.maximum(1.0 - distance, 0.0)
    far = np.maximum(2.0 - distance, 0.0)
    return np.asarray((far**3 - 4.0 * near**3) / 6.0)
