"""The binary side of a glTF file: arrays in, accessors out, one chunk at the end.

Arrays of one kind share a bufferView, which keeps the JSON of a face with fifty morph targets
small.
"""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Json = dict[str, Any]

_COMPONENT = {"uint8": 5121, "uint16": 5123, "uint32": 5125, "float32": 5126}
_SHAPE = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}
_VERTEX, _ELEMENT = 34962, 34963
_TARGET = {"vertex": _VERTEX, "element": _ELEMENT}


@dataclass(slots=True)
class _Stream:
    """What will be one bufferView."""

    view: int
    chunks: list[bytes]
    size: int


class GltfBuffer:
    """Accessors and the bytes behind them."""

    def __init__(self) -> None:
        self.accessors: list[Json] = []
        self._streams: dict[tuple[str, str, int], _Stream] = {}

    def branch(self) -> GltfBuffer:
        """A buffer that begins with what is in this one and is added to by itself."""
        other = GltfBuffer()
        other.accessors = list(self.accessors)
        other._streams = {
            key: _Stream(stream.view, list(stream.chunks), stream.size)
            for key, stream in self._streams.items()
        }
        return other

    def add(
        self,
        values: NDArray[Any],
        use: str = "data",
        *,
        bounds: bool = False,
        normalized: bool = False,
    ) -> int:
        """Index of a new accessor of ``values`` (N,) or (N, 2..4), of a dtype glTF knows.

        ``use`` is "vertex", "element" or "data"; ``bounds`` writes min and max.
        """
        columns = values.shape[1] if values.ndim == 2 else 1
        accessor: Json = self._where(values, use) | {
            "componentType": _COMPONENT[values.dtype.name],
            "count": len(values),
            "type": _SHAPE[columns],
        }
        if bounds:
            accessor |= _bounds(values.reshape(len(values), columns))
        if normalized:
            accessor["normalized"] = True
        return self._append(accessor)

    def add_sparse(
        self, values: NDArray[np.float32], threshold: float, *, bounds: bool = False
    ) -> int:
        """Index of a new accessor of vectors ``values`` (N, 3), of which only those longer than
        ``threshold`` are stored; the others are zero."""
        kept = np.flatnonzero(np.einsum("nx,nx->n", values, values) > threshold**2)
        accessor: Json = {
            "componentType": _COMPONENT["float32"],
            "count": len(values),
            "type": "VEC3",
        }
        stored = values[kept]
        if bounds:
            rest = np.zeros((1 if len(kept) < len(values) else 0, 3), dtype=np.float32)
            accessor |= _bounds(np.concatenate([stored, rest]))
        if len(kept):
            index = kept.astype(np.uint16 if len(values) <= 65536 else np.uint32)
            accessor["sparse"] = {
                "count": len(kept),
                "indices": self._where(index, "data")
                | {"componentType": _COMPONENT[index.dtype.name]},
                "values": self._where(stored, "data"),
            }
        return self._append(accessor)

    def add_image(self, picture: bytes) -> int:
        """Index of a new bufferView that holds a PNG or JPEG file."""
        pixels = np.frombuffer(picture, dtype=np.uint8)
        view: int = self._where(pixels, f"image {len(self._streams)}")["bufferView"]
        return view

    def _append(self, accessor: Json) -> int:
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def _where(self, values: NDArray[Any], use: str) -> Json:
        stride = values.dtype.itemsize * (values.shape[1] if values.ndim == 2 else 1)
        stream = self._streams.setdefault(
            (use, values.dtype.name, stride), _Stream(len(self._streams), [], 0)
        )
        place = {"bufferView": stream.view} | ({"byteOffset": stream.size} if stream.size else {})
        stream.chunks.append(values.astype(values.dtype.newbyteorder("<")).tobytes())
        stream.size += len(stream.chunks[-1])
        return place

    def glb(self, document: Json) -> bytes:
        """The whole GLB file: ``document`` with this buffer's accessors and views added."""
        views, chunks, size = [], [], 0
        for (use, _, stride), stream in self._streams.items():
            chunk = b"".join(stream.chunks)
            view: Json = {"buffer": 0, "byteOffset": size, "byteLength": len(chunk)}
            if use in _TARGET:
                view["target"] = _TARGET[use]
            if use == "vertex":
                view["byteStride"] = stride
            views.append(view)
            chunks.append(_padded(chunk, b"\0"))
            size += len(chunks[-1])
        document = document | {
            "accessors": self.accessors,
            "bufferViews": views,
            "buffers": [{"byteLength": size}],
        }
        text = _padded(json.dumps(document, separators=(",", ":")).encode(), b" ")
        body = struct.pack("<I4s", len(text), b"JSON") + text
        body += struct.pack("<I4s", size, b"BIN\0") + b"".join(chunks)
        return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def _bounds(values: NDArray[Any]) -> Json:
    return {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}


def _padded(chunk: bytes, filler: bytes) -> bytes:
    return chunk + filler * (-len(chunk) % 4)
