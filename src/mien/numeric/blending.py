"""Sums of weighted fields: what a face is made of in every frame."""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

Floats = NDArray[np.float32]

_BLOCK = 2048
"""Columns at a time: the sum stays in the processor's cache while the fields run past it."""


def blend(weights: Floats, fields: Floats) -> Floats:
    """``weights`` (W,) @ ``fields`` (W, N), added up in the order of the fields: (N,).

    Most weights of a frame are nothing, and their fields are not read. The same sum as a matrix
    product wakes as many threads as there are cores, which take turns on a busy machine.
    """
    total = np.zeros(fields.shape[1], dtype=np.float32)
    _add(weights, fields, total)
    return total


@njit(cache=True, nogil=True, error_model="numpy")
def _add(weights: Floats, fields: Floats, total: Floats) -> None:
    for first in range(0, len(total), _BLOCK):
        last = min(len(total), first + _BLOCK)
        for row in range(len(weights)):
            weight, field, sums = weights[row], fields[row, first:last], total[first:last]
            if weight != 0.0:
                for column in range(last - first):
                    sums[column] += weight * field[column]
