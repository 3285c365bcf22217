"""What the browser is sent for every frame: weights travel, meshes do not.

    "MIEN", uint8 version, 3 bytes of nothing
    then sections: 4 letters, uint32 bytes, and those bytes, all little-endian

    MOMT   float64 time of the source, float32 ms late, uint32 state
    PLAY   float64 place in the take and its length, seconds
    PNTS   float32 pairs: tracked points, 0..1 of the picture's width and height
    JPEG   the performer's picture, where the browser does not have it
    C000   float32: head quaternion (4), place (3, metres), eye quaternions (4 + 4), weights
    C001   the same of the second character ...

Who reads passes over sections it does not know.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from mien.numeric.rotation import from_gaze, to_quaternion
from mien.performance.curves import Curves

MAGIC, VERSION = b"MIEN", 1
STATES = ("waiting", "following", "lost")
_METRES = 1e-3


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


def points(places: NDArray[np.floating], size: tuple[int, int]) -> tuple[str, bytes]:
    """Tracked points (N, 2) in pixels of a picture (width, height)."""
    return "PNTS", (places / np.array(size)).astype("<f4").tobytes()


def character(number: int, curves: Curves) -> tuple[str, bytes]:
    """The one frame of ``curves`` of the ``number``-th character on stage."""
    numbers = np.concatenate(
        [
            to_quaternion(curves.rotation[0]),
            curves.translation[0] * _METRES,
            to_quaternion(from_gaze(curves.gaze[0])).ravel(),
            curves.weights[0],
        ]
    )
    return f"C{number:03d}", numbers.astype("<f4").tobytes()
