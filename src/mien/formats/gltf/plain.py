"""A compressed glTF file as if nobody had compressed it.

What meshopt or Draco hold is decoded once, when the file is opened: readers behind see plain
bufferViews, and a take is written into a file that every program opens.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError
from mien.formats.gltf import draco, meshopt
from mien.formats.gltf.accessors import Accessors
from mien.formats.gltf.container import MESHOPT, Container, Json, view_span

_UNDONE = (*MESHOPT, draco.EXTENSION)
_LARGEST = 2**28
"""Bytes that all that is compressed may hold."""
_VERTEX, _ELEMENT = 34962, 34963


def plain(container: Container) -> Container:
    """``container`` with everything decoded, in one buffer; itself where nothing has to be. Raises
    FormatError for what is damaged, MissingExtraError for Draco without its extra."""
    if None not in container.buffers and not any(_held(container)):
        return container
    return _Undoing(container).container()


def _held(container: Container) -> list[Json]:
    """The primitives whose vertices stand in a stream of Draco's and nowhere else."""
    found = []
    for mesh in container.listed("meshes"):
        for primitive in mesh["primitives"] if isinstance(mesh.get("primitives"), list) else []:
            if _extension(primitive, draco.EXTENSION):
                attributes = primitive.get("attributes")
                place = attributes.get("POSITION") if isinstance(attributes, dict) else None
                if "bufferView" not in container.item("accessors", place):
                    container.item("bufferViews", _stream_of(primitive))
                    found.append(primitive)
    return found


class _Undoing:
    """A document on its way to a plain one."""

    def __init__(self, container: Container) -> None:
        self.old = container
        self.layouts = Accessors(container)
        self.accessors = list(container.listed("accessors"))
        self._left = _LARGEST
        self._rounded: set[int] = set()
        views = container.listed("bufferViews")
        self.views = [_without(view, "buffer", "extensions") for view in views]
        self.contents = [self._content(index, view) for index, view in enumerate(views)]
        self.held = _held(container)
        self._streams = {_stream_of(primitive) for primitive in self.held}

    def container(self) -> Container:
        """The plain one."""
        for primitive in self.held:
            self._fill_from_draco(primitive)
        content = bytearray()
        for view, own in zip(self.views, self.contents, strict=True):
            view |= {"buffer": 0, "byteOffset": len(content), "byteLength": len(own)}
            content += own + b"\0" * (-len(own) % 4)
        document = self.old.document | {
            "meshes": [_undressed(mesh) for mesh in self.old.listed("meshes")],
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": len(content)}],
        }
        for key in ("extensionsUsed", "extensionsRequired"):
            names = document.pop(key, None)
            kept = [n for n in names if n not in _UNDONE] if isinstance(names, list) else []
            document |= {key: kept} if kept else {}
        found = Container(self.old.path, document, (bytes(content),))
        self._bound_again(Accessors(found))
        return found

    def _content(self, index: int, view: Json) -> bytes:
        """The bytes of a bufferView, through meshopt where nothing else holds them."""
        told = next(filter(None, (_extension(view, name) for name in MESHOPT)), None)
        number = view.get("buffer", -1)
        self.old.item("buffers", number)
        if told is None or self.old.buffers[number] is not None:
            return self._bytes(view, index)
        count, stride = told.get("count"), told.get("byteStride")
        if type(count) is not int or type(stride) is not int or min(count, stride) < 1:
            raise self._damaged(index, "it has no count or stride")
        if view.get("byteLength") != count * stride:
            raise self._damaged(index, "it is of another length than it says")
        self._take(count * stride)
        stream = self._bytes(told, index)
        mode, way = str(told.get("mode")), str(told.get("filter", "NONE"))
        if way == "EXPONENTIAL":
            self._rounded.add(index)
        try:
            return meshopt.decode(stream, count, stride, mode, way)
        except ValueError as error:
            raise self._damaged(index, str(error)) from error

    def _bound_again(self, accessors: Accessors) -> None:
        """Bounds of floats that were rounded after their bounds were written down."""
        for index, accessor in enumerate(self.accessors):
            if accessor.get("bufferView") in self._rounded and "min" in accessor:
                _, columns, _ = accessors.layout(index)
                values = accessors.read(index, columns).reshape(-1, columns)
                self.accessors[index] = accessor | _bounds(values)

    def _fill_from_draco(self, primitive: Json) -> None:
        """Give a primitive's accessors what its stream holds."""
        index = _stream_of(primitive)
        stream = self._bytes(self.old.item("bufferViews", index), index)
        try:
            corners, attributes = draco.decode(stream, self.old.path)
        except ValueError as error:
            raise self._damaged(index, str(error)) from error
        self._fill(primitive.get("indices"), corners[:, None], _ELEMENT, index)
        numbers = _extension(primitive, draco.EXTENSION).get("attributes")
        for name, number in numbers.items() if isinstance(numbers, dict) else ():
            values = attributes.get(number) if type(number) is int else None
            if values is None or name not in primitive["attributes"]:
                raise self._damaged(index, f"it has not the attribute {name[:40]!r}")
            self._fill(primitive["attributes"][name], values, _VERTEX, index)
        if "bufferView" not in self.accessors[primitive["attributes"]["POSITION"]]:
            raise self._damaged(index, "it has no places")

    def _fill(self, place: Any, values: NDArray[Any], target: int, index: int) -> None:
        """Give an accessor ``values`` (N, columns) of the stream ``index``."""
        count, columns, dtype = self.layouts.layout(place)
        with np.errstate(invalid="ignore", over="ignore"):
            own = values.astype(dtype)
        if values.shape != (count, columns) or not np.array_equal(own, values):
            raise self._damaged(index, f"it does not fit accessors[{place}]")
        row = dtype.itemsize * columns
        stride = row + -row % 4 if target == _VERTEX else row
        padded = np.zeros((count, stride), np.uint8)
        padded[:, :row] = np.ascontiguousarray(own).view(np.uint8).reshape(count, row)
        self._take(padded.size)
        filled: Json = {"bufferView": self._view(padded.tobytes(), target, index)}
        if stride != row:
            self.views[filled["bufferView"]]["byteStride"] = stride
        if "min" in self.accessors[place]:
            filled |= _bounds(own)
        self.accessors[place] = self.accessors[place] | filled

    def _view(self, content: bytes, target: int, index: int) -> int:
        """Number of a bufferView of ``content``: at first the stream's own, which nobody needs."""
        if index not in self._streams:
            index = len(self.views)
            self.views.append({})
            self.contents.append(b"")
        self._streams.discard(index)
        self.views[index], self.contents[index] = {"target": target}, content
        return index

    def _bytes(self, place: Json, index: int) -> bytes:
        content, start, end = view_span(self.old, place, f"bufferViews[{index}]")
        return content[start:end]

    def _take(self, size: int) -> None:
        self._left -= size
        if self._left < 0:
            raise self.old.fault(f"holds more than {_LARGEST >> 20} MB when decoded; refused")

    def _damaged(self, index: object, why: str) -> FormatError:
        return self.old.fault(f"bufferViews[{index}] cannot be decoded: {why}; export it again")


def _stream_of(primitive: Json) -> Any:
    return _extension(primitive, draco.EXTENSION).get("bufferView")


def _bounds(values: NDArray[Any]) -> Json:
    return {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}


def _undressed(mesh: Json) -> Json:
    """``mesh`` without a word of Draco."""
    if not isinstance(mesh.get("primitives"), list):
        return mesh
    primitives = []
    for primitive in mesh["primitives"]:
        if _extension(primitive, draco.EXTENSION):
            rest = _without(primitive["extensions"], draco.EXTENSION)
            primitive = _without(primitive, "extensions") | ({"extensions": rest} if rest else {})
        primitives.append(primitive)
    return mesh | {"primitives": primitives}


def _extension(holder: object, name: str) -> Json:
    """What an extension says of something; empty where it says nothing."""
    extensions = holder.get("extensions") if isinstance(holder, dict) else None
    told = extensions.get(name) if isinstance(extensions, dict) else None
    return told if isinstance(told, dict) else {}


def _without(told: Json, *names: str) -> Json:
    return {name: value for name, value in told.items() if name not in names}
