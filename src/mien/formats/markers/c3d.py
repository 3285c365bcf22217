"""C3D, the format of optical motion capture (c3d.org): points only, analog data is passed over.

Read here and not by a library: those at hand can be made to crash by a damaged file. Integer and
float data, Intel, DEC and MIPS processors; frames, labels and scale as the parameters have them,
which the header may contradict (more than 65535 frames, more than 255 labels).
"""

from __future__ import annotations

import math
import struct
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError, InputError
from mien.formats.meshes.lengths import millimetres
from mien.performance.marker_take import MarkerTake

Array = NDArray[np.float64]

_BLOCK = 512
_KEY = 0x50
_INTEL, _DEC, _MIPS = 84, 85, 86
_MOST_BYTES = 2**31
_MOST_POINTS = 4096
_MOST_PLACES = 40_000_000
"""Frames times markers: a gigabyte of memory."""
_BROKEN = (ValueError, IndexError, struct.error, OverflowError)
"""What a file that is no C3D makes the parts below raise."""

Parameters = dict[str, tuple[int, list[int], bytes]]
"""GROUP:NAME -> type, dimensions, data."""


def read_c3d(path: Path | str, units: str | None = None) -> MarkerTake:
    """Read the markers of a C3D file. ``units`` of its numbers, where it does not name them or
    names them wrongly.

    Raises InputError where it cannot be read, FormatError where it is broken, empty, or of an
    unknown unit.
    """
    path = Path(path)
    data = _bytes(path)
    try:
        reader = _Reader(data)
        places, labels = reader.places(), reader.labels()
        rate, said = reader.rate(), reader.text("POINT:UNITS")
    except _BROKEN as error:
        raise FormatError(f"{path}: not a C3D file, or a broken one ({error})") from error
    if not places.shape[0] or not places.shape[1]:
        raise FormatError(f"{path}: holds no markers; export the trajectories with it")
    if not np.isfinite(places).any():
        raise FormatError(f"{path}: no marker was seen in any frame")
    unit = millimetres(path, said, units, places)
    return MarkerTake(labels, np.arange(len(places)) / rate, places * unit, unit, path.name)


def _bytes(path: Path) -> bytes:
    try:
        if path.stat().st_size > _MOST_BYTES:
            raise FormatError(f"{path}: larger than 2 GB; cut the take into parts")
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot be read ({error.strerror})") from error


@dataclass(frozen=True, slots=True)
class _Numbers:
    """How a processor writes numbers."""

    order: str
    float32: Callable[[bytes], Array]


def _vax(data: bytes) -> Array:
    """DEC's F-floats: the halves exchanged, the exponent two higher."""
    halves = np.frombuffer(data, "<u2").reshape(-1, 2)[:, ::-1]
    return np.asarray(np.ascontiguousarray(halves).view("<f4").ravel().astype(float) / 4.0)


_PROCESSORS = {
    _INTEL: _Numbers("<", lambda data: np.frombuffer(data, "<f4").astype(float)),
    _DEC: _Numbers("<", _vax),
    _MIPS: _Numbers(">", lambda data: np.frombuffer(data, ">f4").astype(float)),
}


class _Reader:
    """One file's header, parameters and points."""

    def __init__(self, data: bytes) -> None:
        if len(data) < 2 * _BLOCK or data[1] != _KEY:
            raise ValueError("no C3D header")
        self._data = data
        begin = (data[0] - 1) * _BLOCK
        processor = _PROCESSORS.get(data[begin + 3])
        if begin < _BLOCK or processor is None:
            raise ValueError("written by an unknown processor")
        self._numbers = processor
        order = processor.order
        words = struct.unpack_from(order + "5H", data, 2)
        self._points, self._analog, self._first, self._last = words[:4]
        (self._block,) = struct.unpack_from(order + "H", data, 16)
        self._header_scale = float(processor.float32(data[12:16])[0])
        self._header_rate = float(processor.float32(data[20:24])[0])
        self._parameters = self._walk(begin + 4)

    def _walk(self, at: int) -> Parameters:
        """Groups and parameters, which follow each other as a chain of offsets."""
        data, order = self._data, self._numbers.order
        groups: dict[int, str] = {}
        found: list[tuple[int, str, tuple[int, list[int], bytes]]] = []
        while at + 2 <= len(data) and data[at]:
            length, group = abs(struct.unpack_from("b", data, at)[0]), data[at + 1]
            name = data[at + 2 : at + 2 + length].decode("ascii", "replace").strip().upper()
            at += 2 + length
            (step,) = struct.unpack_from(order + "H", data, at)
            if group > 127:
                groups[256 - group] = name
            else:
                found.append((group, name, self._value(at + 2)))
            if step < 2:
                break
            at += step
        return {f"{groups.get(group, group)}:{name}": value for group, name, value in found}

    def _value(self, at: int) -> tuple[int, list[int], bytes]:
        data = self._data
        (kind,) = struct.unpack_from("b", data, at)
        shape = list(data[at + 2 : at + 2 + data[at + 1]])
        begin = at + 2 + len(shape)
        size = abs(kind) * math.prod(shape)
        if len(data) < begin + size:
            raise ValueError("its parameters are cut short")
        return kind, shape, data[begin : begin + size]

    def numbers(self, name: str) -> list[float]:
        """Values of a parameter, or none."""
        kind, _, data = self._parameters.get(name, (0, [], b""))
        if kind == 4:
            return [float(x) for x in self._numbers.float32(data)]
        if kind == 2:
            return [float(x) for x in np.frombuffer(data, self._numbers.order + "u2")]
        return [float(x) for x in data] if kind == 1 else []

    def texts(self, name: str) -> list[str]:
        """Strings of a parameter, or none."""
        kind, shape, data = self._parameters.get(name, (0, [], b""))
        if kind != -1 or not data:
            return []
        width = shape[0] if shape else 1
        cells = [data[i : i + width] for i in range(0, len(data), width)]
        return [cell.decode("utf-8", "replace").strip(" \0") for cell in cells]

    def text(self, name: str) -> str:
        """The first of them."""
        return next(iter(self.texts(name)), "")

    def rate(self) -> float:
        """Frames a second."""
        said = [*self.numbers("POINT:RATE")[:1], self._header_rate]
        for rate in said:
            if 0.1 <= rate <= 1e5:
                return rate
        raise ValueError(f"a frame rate of {said[0]:g}")

    def labels(self) -> tuple[str, ...]:
        """(M) without the prefix that names the subject; "*3" where there is none."""
        labels = self.texts("POINT:LABELS")
        for more in range(2, _MOST_POINTS // 255 + 2):
            labels += self.texts(f"POINT:LABELS{more}")
        named = [label.rpartition(":")[2].strip() for label in labels[: self._count()]]
        named += [""] * (self._count() - len(named))
        return tuple(label or f"*{i}" for i, label in enumerate(named))

    def places(self) -> Array:
        """(F, M, 3) in the file's unit, NaN where a marker was not seen."""
        frames, points, scale = self._frames(), self._count(), self._scale()
        width = 4 if scale < 0 else 2
        size = width * (4 * points + self._analog)
        begin = self._start()
        if frames * points > _MOST_PLACES:
            raise ValueError(f"{frames} frames of {points} markers")
        held = self._data[begin : begin + frames * size]
        if len(held) < frames * size:
            raise ValueError(f"it promises {frames} frames and holds {len(held) // max(size, 1)}")
        rows = np.frombuffer(held, np.uint8).reshape(frames, size)[:, : width * 4 * points]
        raw = rows.tobytes()
        if width == 4:
            values = self._numbers.float32(raw)
        else:
            values = np.frombuffer(raw, self._numbers.order + "i2").astype(float)
        values = values.reshape(frames, points, 4)
        places = values[..., :3] * (scale if scale > 0 else 1.0)
        # Some writers put zeros where nothing was seen and leave the residual at zero.
        seen = (values[..., 3] >= 0) & np.isfinite(places).all(axis=-1) & places.any(axis=-1)
        places[~seen | (np.abs(places) > 1e7).any(axis=-1)] = np.nan
        return places

    def _count(self) -> int:
        said = self.numbers("POINT:USED")
        count = int(said[0]) if said else self._points
        if count != self._points or count > _MOST_POINTS:
            raise ValueError(f"{count} markers by its parameters, {self._points} by its header")
        return count

    def _scale(self) -> float:
        said = self.numbers("POINT:SCALE")
        scale = said[0] if said else self._header_scale
        if not math.isfinite(scale) or scale == 0 or abs(scale) > 1e6:
            raise ValueError(f"a scale of {scale:g}")
        return scale

    def _start(self) -> int:
        said = self.numbers("POINT:DATA_START")
        block = int(said[0]) if said and said[0] >= 2 else self._block
        if block < 2:
            raise ValueError("its data begins nowhere")
        return (block - 1) * _BLOCK

    def _frames(self) -> int:
        """As the most trustworthy of three places has it: two of them hold 16 bits."""
        start, end = (self.numbers(f"TRIAL:ACTUAL_{which}_FIELD") for which in ("START", "END"))
        if len(start) == len(end) == 2:
            fields = int(end[0] - start[0]) + 65536 * int(end[1] - start[1])
            return max(fields + 1, 0)
        said = self.numbers("POINT:FRAMES")
        header = max(self._last - self._first + 1, 0)
        if said and int(said[0]) != 65535 and (header == 0 or said[0] == header % 65536):
            return int(said[0])
        return int(header)
