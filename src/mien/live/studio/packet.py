"""What the browser is sent for every frame: weights travel, meshes do not.

    "MIEN", uint8 version, 3 bytes of nothing
    then sections: 4 letters, uint32 bytes, and those bytes, all little-endian

    MOMT   float64 time of the source, float32 ms late, uint32 state
    PLAY   float64 place in the take and its length, seconds
    CROW   uint32 faces in view, where there are several
    HOLD   float32 how much of a face that is held has been seen, 0..1
    PNTS   float32 pairs: tracked points, 0..1 of the picture's width and height
    LINE   the same: points of one tracked curve; as many sections as there are curves
    WIRE   the same: two for each edge of a fitted mesh
    JPEG   the performer's picture, where the browser does not have it
    C000   float32: head quaternion (4), place (3, metres), eye quaternions (4 + 4), weights
    C001   the same of the second character ...

Who reads passes over sections it does not know.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from time import perf_counter

import numpy as np

from mien.numeric.rotation import from_gaze, to_quaternion
from mien.performance.curves import Curves
from mien.performance.performance import Performance
from mien.performance.trace import Trace

MAGIC, VERSION = b"MIEN", 1
STATES = ("waiting", "following", "lost")
_METRES = 1e-3
_FIELD = 270.0
"""Millimetres from one border to the other where a performance without pictures is shown."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What is sent for one frame."""

    at: float
    """When the frame came, on the performance counter."""
    time: float
    """Seconds, of its source."""
    state: str
    sections: list[tuple[str, bytes]]

    def sent(self) -> bytes:
        """The message, as late as it is now."""
        late = 1e3 * (perf_counter() - self.at)
        return packet([moment(self.time, late, self.state), *self.sections])


def packet(sections: list[tuple[str, bytes]]) -> bytes:
    """One message of named sections."""
    parts = [MAGIC + bytes([VERSION, 0, 0, 0])]
    for tag, body in sections:
        parts.append(struct.pack("<4sI", tag.encode(), len(body)) + body)
    return b"".join(parts)


def unpack(message: bytes) -> Iterator[tuple[str, bytes]]:
    """The sections of a message. Raises ValueError where it is none."""
    if message[:5] != MAGIC + bytes([VERSION]):
        raise ValueError("not a packet of this version")
    place = 8
    while place < len(message):
        tag, size = struct.unpack_from("<4sI", message, place)
        place += 8
        if place + size > len(message):
            raise ValueError("a section longer than its packet")
        yield tag.decode(), message[place : place + size]
        place += size


def moment(time: float, late_ms: float, state: str) -> tuple[str, bytes]:
    """When it was, how late this is, and whether a face is followed."""
    return "MOMT", struct.pack("<dfI", time, late_ms, STATES.index(state))


def playing(place: float, length: float) -> tuple[str, bytes]:
    """Where in a take we are, seconds."""
    return "PLAY", struct.pack("<dd", place, length)


def holding(share: float) -> tuple[str, bytes]:
    """How much of a face that is held has been seen, 0..1."""
    return "HOLD", struct.pack("<f", share)


def traced(trace: Trace, size: tuple[int, int]) -> list[tuple[str, bytes]]:
    """What was seen in a picture (width, height) pixels."""
    sections = [("CROW", struct.pack("<I", trace.faces))] if trace.faces > 1 else []
    tagged = [("PNTS", trace.points), *(("LINE", curve) for curve in trace.curves.values())]
    tagged += [("WIRE", trace.wire)] if len(trace.wire) else []
    for tag, places in tagged:
        sections.append((tag, (places / np.array(size)).astype("<f4").tobytes()))
    return sections


def posed(performance: Performance) -> tuple[str, bytes]:
    """The points of a performance of one frame that has no pictures, as somebody sees them who
    faces the performer."""
    middle = (performance.neutral.min(axis=0) + performance.neutral.max(axis=0)) / 2.0
    rotation, _ = performance.head()
    places = (performance.neutral - middle + performance.motion[0]) @ rotation[0].T
    return "PNTS", (0.5 + places[:, :2] * (1.0, -1.0) / _FIELD).astype("<f4").tobytes()


def character(number: int, curves: Curves, names: Sequence[str]) -> tuple[str, bytes]:
    """The one frame of ``curves`` of the ``number``-th character on stage, whose weights are told
    in the order of ``names``; what the curves do not name is 0."""
    weight = dict(zip(curves.names, curves.weights[0], strict=True))
    numbers = np.concatenate(
        [
            to_quaternion(curves.rotation[0]),
            curves.translation[0] * _METRES,
            to_quaternion(from_gaze(curves.gaze[0])).ravel(),
            [weight.get(name, 0.0) for name in names],
        ]
    )
    return f"C{number:03d}", numbers.astype("<f4").tobytes()
