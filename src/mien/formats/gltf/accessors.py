"""Arrays out of a glTF file, bounds first."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.formats.gltf.container import Container, Json, view_span

_TYPES = {5120: "|i1", 5121: "|u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
_MAX_COUNT = 20_000_000


class Accessors:
    """The accessors of a container."""

    def __init__(self, container: Container) -> None:
        self.container = container

    def count(self, index: object) -> int:
        """How many elements an accessor promises, before anything is read."""
        count = self.container.item("accessors", index).get("count")
        if type(count) is not int or not 1 <= count <= _MAX_COUNT:
            raise self._fault(index, f"has the count {str(count)[:40]!r}")
        return count

    def layout(self, index: object) -> tuple[int, int, np.dtype[Any]]:
        """Count, columns (0 where mien knows them not) and type of an accessor's elements."""
        described = self.container.item("accessors", index)
        dtype = self._dtype(index, described.get("componentType"))
        return self.count(index), _COLUMNS.get(str(described.get("type")), 0), dtype

    def read(self, index: object, columns: int) -> NDArray[Any]:
        """(N, ``columns``) values, or (N,) for one column: integers as they are, floats, and
        normalized integers as floats. Raises FormatError."""
        described = self.container.item("accessors", index)
        count, own, dtype = self.layout(index)
        if own != columns:
            raise self._fault(index, f"is {described.get('type')!r}, not of {columns} columns")
        if "bufferView" in described:
            values = self._view(index, described, dtype, count, columns)
        else:
            values = np.zeros((count, columns), dtype)
        if "sparse" in described:
            values = self._sparse(index, described["sparse"], values.copy())
        if described.get("normalized") and dtype.kind in "iu":
            values = np.maximum(values / np.float64(np.iinfo(dtype).max), -1.0)
        if values.dtype.kind == "f" and not np.isfinite(values).all():
            raise self._fault(index, "holds values that are not numbers")
        return values[:, 0] if columns == 1 else values

    def view_bytes(self, index: object) -> bytes:
        """All bytes of a bufferView."""
        content, start, end = self._span(self.container.item("bufferViews", index), index)
        return content[start:end]

    def _sparse(self, index: object, sparse: Json, values: NDArray[Any]) -> NDArray[Any]:
        if not isinstance(sparse, dict) or not all(
            isinstance(sparse.get(part), dict) for part in ("indices", "values")
        ):
            raise self._fault(index, "is sparse without indices or values")
        count = sparse.get("count")
        if type(count) is not int or not 1 <= count <= len(values):
            raise self._fault(index, f"replaces {str(count)[:40]} of {len(values)} elements")
        kind = self._dtype(index, sparse["indices"].get("componentType"))
        if kind.kind != "u":
            raise self._fault(index, "has sparse indices that are not unsigned")
        rows = self._view(index, sparse["indices"], kind, count, 1)[:, 0].astype(np.int64)
        if rows[-1] >= len(values) or (np.diff(rows) <= 0).any():
            raise self._fault(index, "has sparse indices out of order or past its end")
        values[rows] = self._view(index, sparse["values"], values.dtype, count, values.shape[1])
        return values

    def _view(
        self, index: object, where: Json, dtype: np.dtype[Any], count: int, columns: int
    ) -> NDArray[Any]:
        number = where.get("bufferView")
        view = self.container.item("bufferViews", number)
        content, start, end = self._span(view, number)
        offset, stride = where.get("byteOffset", 0), view.get("byteStride")
        packed = dtype.itemsize * columns
        if stride is None:
            stride = packed
        if type(stride) is not int or not packed <= stride <= 252:
            raise self._fault(index, f"has a stride of {str(stride)[:20]} for {packed} bytes")
        if type(offset) is not int or offset < 0:
            raise self._fault(index, f"begins at {str(offset)[:20]!r}")
        if offset + stride * (count - 1) + packed > end - start:
            raise self._fault(index, "reaches past the end of its bufferView")
        return np.ndarray(
            (count, columns), dtype, content, start + offset, (stride, dtype.itemsize)
        )

    def _span(self, view: Json, number: object) -> tuple[bytes, int, int]:
        return view_span(self.container, view, f"bufferViews[{number}]")

    def _dtype(self, index: object, component: object) -> np.dtype[Any]:
        if not isinstance(component, int) or component not in _TYPES:
            raise self._fault(index, f"has the unknown componentType {str(component)[:40]!r}")
        return np.dtype(_TYPES[component])

    def _fault(self, index: object, what: str) -> Exception:
        return self.container.fault(f"accessors[{index}] {what}; export it again")
