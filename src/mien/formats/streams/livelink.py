"""Datagrams of Live Link Face's ARKit stream, version 6: big-endian, port 11111.

    uint8 version, int32 length and device id, int32 length and subject name,
    int32 frame number, float32 sub frame, int32 rate over int32, uint8 count, count x float32

A datagram that ends before the count tells that no face is tracked. Angles have the signs of the
app's recorded takes (see formats/takes/livelink.py).
"""

from __future__ import annotations

import struct
from dataclasses import replace

import numpy as np

from mien.errors import FormatError
from mien.formats.takes.livelink import LARGEST, swapped_names
from mien.numeric.euler import from_euler, to_euler
from mien.performance.arkit_frame import ArkitFrame
from mien.vocabulary.arkit import names
from mien.vocabulary.livelink import ANGLES, FRAMES_PER_SECOND

PORT = 11111
LARGEST_DATAGRAM = 1024
VERSION = 6

_VALUES = len(names()) + len(ANGLES)
_NAME_MAX = 256
_HEAD_SIGNS = (-1.0, -1.0, 1.0)


def encode(frame: ArkitFrame, number: int, *, subject: str = "mien", device: str = "mien") -> bytes:
    """The datagram that tells ``frame``, the ``number``-th of a stream at 60 frames a second."""
    device_id, name = device.encode()[:_NAME_MAX], subject.encode()[:_NAME_MAX]
    head = struct.pack(f">Bi{len(device_id)}si", VERSION, len(device_id), device_id, len(name))
    head += name + struct.pack(">ifii", number & 0x7FFFFFFF, 0.0, FRAMES_PER_SECOND, 1)
    if not frame.seen:
        return head
    angles = np.zeros(len(ANGLES))
    angles[:3] = to_euler(frame.rotation) * _HEAD_SIGNS
    angles[3:5], angles[6:8] = -frame.gaze
    values = np.concatenate([frame.shapes, angles])
    return head + bytes([_VALUES]) + values.astype(">f4").tobytes()


class Decoder:
    """Reads a stream, datagram by datagram; a face that is lost keeps its last look."""

    def __init__(self, swap_sideways: bool = False) -> None:
        """``swap_sideways`` exchanges jaw and mouth left and right, which some versions of the
        app name the wrong way round."""
        spoken = names()
        self._order = [spoken.index(name) for name in swapped_names(swap_sideways)]
        self._last = ArkitFrame(0.0, np.zeros(len(spoken)))

    def decode(self, datagram: bytes) -> ArkitFrame:
        """The frame in ``datagram``, its time counted by the sender. Raises FormatError."""
        try:
            time, values = _parse(datagram)
        except (struct.error, UnicodeDecodeError, ValueError) as error:
            raise FormatError(f"not a Live Link Face datagram ({error})") from error
        if values is None:
            self._last = replace(self._last, time=time, seen=False)
            return self._last
        shapes, angles = values[: len(self._order)], values[len(self._order) :]
        self._last = ArkitFrame(
            time=time,
            shapes=shapes[self._order],
            rotation=from_euler(angles[:3] * _HEAD_SIGNS),
            gaze=-np.stack([angles[3:5], angles[6:8]]),
        )
        return self._last


def _parse(datagram: bytes) -> tuple[float, np.ndarray | None]:
    """Time in seconds and the values (61,), or None where no face is tracked."""
    if not 0 < len(datagram) <= LARGEST_DATAGRAM:
        raise ValueError(f"{len(datagram)} bytes")
    if datagram[0] != VERSION:
        raise ValueError(f"version {datagram[0]}, expected {VERSION}")
    _, place = _text(datagram, 1)
    _, place = _text(datagram, place)
    number, part, rate, over = struct.unpack_from(">ifii", datagram, place)
    if not (0 < rate <= 1000 and 0 < over <= 1001 and 0.0 <= part <= 1.0):
        raise ValueError("impossible frame rate")
    time = (number + part) * over / rate
    place += 16
    if place == len(datagram):
        return time, None
    if datagram[place] != _VALUES or len(datagram) != place + 1 + 4 * _VALUES:
        raise ValueError(f"{datagram[place]} values, expected {_VALUES}")
    values = np.frombuffer(datagram, ">f4", _VALUES, place + 1).astype(float)
    if not (np.abs(values) <= LARGEST).all():
        raise ValueError("a value beyond all bounds")
    return time, values


def _text(datagram: bytes, place: int) -> tuple[str, int]:
    (length,) = struct.unpack_from(">i", datagram, place)
    if not 0 <= length <= _NAME_MAX or place + 4 + length > len(datagram):
        raise ValueError("a name longer than the datagram")
    return datagram[place + 4 : place + 4 + length].decode(), place + 4 + length
