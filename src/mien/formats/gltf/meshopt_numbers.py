"""Numbers as meshopt's streams hold them."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numba import njit
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]
Whole = NDArray[np.int64]
"""Bytes on which numba reckons: unsigned ones it would turn into floats."""
Int: TypeAlias = int | np.int64

kernel = njit(cache=True, nogil=True)


@kernel
def unzigzag(value: Int) -> Int:
    """A signed number from one whose lowest bit is the sign."""
    return ~(value >> 1) if value & 1 else value >> 1


@kernel
def joined(few: Whole) -> Int:
    """A number from its bytes, the least first."""
    value = np.int64(0)
    for i in range(len(few)):
        value |= few[i] << 8 * i
    return value


@kernel
def number(data: Bytes, at: Int, end: Int) -> tuple[Int, Int]:
    """An unsigned number in groups of seven bits, and the place after it, -1 where it has none
    before ``end``."""
    value = np.int64(0)
    for i in range(5):
        if at >= end:
            break
        value |= np.int64(data[at] & 0x7F) << 7 * i
        at += 1
        if data[at - 1] < 0x80:
            return value & 0xFFFFFFFF, at
    return value, -1
