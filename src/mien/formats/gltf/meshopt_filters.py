"""What meshopt does to directions, turns, floats and colours before it stores them, undone.

Source: KHR_meshopt_compression, appendix B.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]
Floats = NDArray[np.float32]


def plain(elements: Bytes) -> Bytes:
    """``elements`` (N, stride) as they are."""
    return elements


def directions(elements: Bytes) -> Bytes:
    """Unit vectors from two octahedral coordinates and one; the fourth component goes through."""
    values = _signed(elements)
    most = np.iinfo(values.dtype).max
    one = np.maximum(values[:, 2].astype(np.float32), 1.0)
    x, y = (values[:, i].astype(np.float32) / one for i in (0, 1))
    z = 1.0 - np.abs(x) - np.abs(y)
    behind = np.minimum(z, 0.0)
    x, y = x - np.copysign(behind, x), y - np.copysign(behind, y)
    length = np.sqrt(x * x + y * y + z * z)
    for i, part in enumerate((x, y, z)):
        values[:, i] = _rounded(part / length * most).clip(-most, most)
    return values.view(np.uint8)


def turns(elements: Bytes) -> Bytes:
    """Unit quaternions from their three smaller components."""
    values = _signed(elements, (8,))
    one = np.maximum((values[:, 3] | 3).astype(np.float32), 3.0)
    smaller = values[:, :3].astype(np.float32) / one[:, None] / np.float32(np.sqrt(2.0))
    largest = np.sqrt(np.maximum(1.0 - (smaller**2).sum(axis=1), 0.0))
    parts = np.concatenate([largest[:, None], smaller], axis=1)
    columns = ((values[:, 3] & 3)[:, None] + np.arange(4)) % 4
    turned = np.empty_like(values)
    np.put_along_axis(
        turned, columns, _rounded(parts * 32767.0).clip(-32767, 32767).astype(np.int16), axis=1
    )
    return turned.view(np.uint8)


def floats(elements: Bytes) -> Bytes:
    """Floats from an exponent of 8 and a mantissa of 24 bits."""
    values = elements.view("<i4")
    mantissa = (values << 8) >> 8
    found = np.ldexp(mantissa.astype(np.float32), (values >> 24).clip(-100, 100))
    return np.asarray(found).view(np.uint8)


def colours(elements: Bytes) -> Bytes:
    """Red, green, blue and alpha from luma, two differences and alpha."""
    values = _signed(elements)
    unsigned = values.view(values.dtype.str.replace("i", "u"))
    most = np.iinfo(unsigned.dtype).max
    orange, green = (values[:, i].astype(np.int32) for i in (1, 2))
    luma = unsigned[:, 0].astype(np.int32)
    marked = np.maximum(unsigned[:, 3].astype(np.int32), 1)
    scale = (1 << (np.floor(np.log2(marked)).astype(np.int32) + 1)) - 1
    alpha = marked & (scale >> 1)
    parts = (
        luma + orange - green,
        luma + green,
        luma - orange - green,
        (alpha << 1) | (alpha & 1),
    )
    factor = np.float32(most) / scale.astype(np.float32)
    found = np.stack([part * factor for part in parts], axis=1)
    return _rounded(found).clip(0, most).astype(unsigned.dtype).view(np.uint8)


FILTERS: Mapping[str, Callable[[Bytes], Bytes]] = {
    "NONE": plain,
    "OCTAHEDRAL": directions,
    "QUATERNION": turns,
    "EXPONENTIAL": floats,
    "COLOR": colours,
}
"""Elements (N, stride) into elements; ValueError for a stride that a filter has not."""


def _signed(elements: Bytes, strides: tuple[int, ...] = (4, 8)) -> NDArray[np.signedinteger]:
    """(N, 4) signed components of elements of 4 or 8 bytes."""
    if elements.shape[1] not in strides:
        raise ValueError("its filter does not fit its stride")
    return elements.view(f"<i{elements.shape[1] // 4}")


def _rounded(values: NDArray[np.floating]) -> Floats:
    """Halves away from zero."""
    return np.asarray(np.copysign(np.floor(np.abs(values) + 0.5), values), dtype=np.float32)
