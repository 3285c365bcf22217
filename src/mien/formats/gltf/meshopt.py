"""The streams of EXT_meshopt_compression and KHR_meshopt_compression, decoded.

Source: their specification in Khronos' registry. A stream is refused where it ends early, where
bytes are left over, and where it reads what was never written.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.formats.gltf.meshopt_attributes import attributes
from mien.formats.gltf.meshopt_filters import FILTERS
from mien.formats.gltf.meshopt_indices import indices, triangles


def decode(stream: bytes, count: int, stride: int, mode: str, kind: str = "NONE") -> bytes:
    """``count`` elements of ``stride`` bytes from a stream in the ``mode`` "ATTRIBUTES",
    "TRIANGLES" or "INDICES", through the filter ``kind``. Raises ValueError where stream and
    layout are none there is or do not fit each other."""
    data = np.frombuffer(stream, np.uint8)
    if mode == "ATTRIBUTES" and kind in FILTERS and stride in range(4, 257, 4):
        elements = np.zeros((count, stride), np.uint8)
        sound = attributes(data, elements)
        return _bytes(FILTERS[kind](elements) if sound else elements, sound)
    found = np.zeros(count, np.uint32)
    if kind != "NONE" or stride not in (2, 4) or mode not in ("TRIANGLES", "INDICES"):
        raise ValueError("its layout is none that meshopt has")
    sound = indices(data, found) if mode == "INDICES" else count % 3 == 0 and triangles(data, found)
    return _bytes(found.astype(f"<u{stride}"), sound)


def _bytes(values: NDArray[Any], sound: bool) -> bytes:
    if not sound:
        raise ValueError("its stream is damaged")
    return values.tobytes()
