"""Datagrams of iFacialMocap: text, port 49983.

    name-value|...|=head#rx,ry,rz,px,py,pz|rightEye#rx,ry,rz|leftEye#rx,ry,rz|

Shapes are 0 to 100 under ARKit's names with _L and _R; version 2 writes "name&value". Angles are
degrees. The eyes' were read off two real frames against their look weights: turning about axes that
are the head frame's own, x down and y to the subject's left; the head's are taken to be of the same
kind, and its place metres before the camera.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mien.errors import FormatError
from mien.numeric.euler import from_euler, to_euler
from mien.performance.arkit_frame import ArkitFrame
from mien.vocabulary.arkit import names

PORT = 49983
LARGEST_DATAGRAM = 8192
HELLO = b"iFacialMocap_sahuasouryya9218sauhuiayeta91555dy3719"
"""What a receiver sends to the phone so that it starts."""

Array = NDArray[np.float64]

_WHOLE = ("jawLeft", "jawRight", "mouthLeft", "mouthRight")
_PERCENT, _MILLIMETRES = 100.0, 1000.0
_LARGEST_SHAPE, _LARGEST_NUMBER = 500.0, 1e4
_MOST_FIELDS = 256


def spelled(name: str) -> str:
    """iFacialMocap's spelling of an ARKit shape: "eyeBlink_L" for "eyeBlinkLeft"."""
    if name in _WHOLE:
        return name
    if name.endswith("Left"):
        return f"{name.removesuffix('Left')}_L"
    return f"{name.removesuffix('Right')}_R" if name.endswith("Right") else name


_SPELLED = tuple(spelled(name) for name in names())
_ROW = {name: row for row, name in enumerate(_SPELLED)}


def encode(frame: ArkitFrame) -> bytes:
    """The datagram (version 2) that tells ``frame``."""
    fields = [f"trackingStatus&{int(frame.seen)}"]
    fields += [
        f"{name}&{weight * _PERCENT:.4g}"
        for name, weight in zip(_SPELLED, frame.shapes, strict=True)
    ]
    turn = _degrees(to_euler(frame.rotation))
    place = frame.translation / _MILLIMETRES
    blocks = {"=head": np.concatenate([turn, place])}
    for eye, gaze in zip(("leftEye", "rightEye"), frame.gaze, strict=True):
        blocks[eye] = _degrees(np.append(gaze, 0.0))
    fields += [f"{name}#{','.join(f'{v:.7g}' for v in block)}" for name, block in blocks.items()]
    return ("|".join(fields) + "|").encode()


class Decoder:
    """Reads a stream, datagram by datagram; what one leaves out keeps its last value."""

    def __init__(self) -> None:
        self._last = ArkitFrame(0.0, np.zeros(len(_SPELLED)))

    def decode(self, datagram: bytes, time: float = 0.0) -> ArkitFrame:
        """The frame in ``datagram``, received at ``time``: the format carries none. Raises
        FormatError."""
        try:
            self._last = self._read(datagram, time)
        except (UnicodeDecodeError, ValueError) as error:
            raise FormatError(f"not an iFacialMocap datagram ({error})") from error
        return self._last

    def _read(self, datagram: bytes, time: float) -> ArkitFrame:
        if len(datagram) > LARGEST_DATAGRAM:
            raise ValueError(f"{len(datagram)} bytes")
        fields = datagram.decode("ascii").removesuffix("___iFacialMocap").split("|")
        if len(fields) > _MOST_FIELDS:
            raise ValueError(f"{len(fields)} fields")
        frame = replace(self._last, time=time, seen=True, shapes=self._last.shapes.copy())
        gaze, known = frame.gaze.copy(), 0
        for field in fields:
            name, block = _block(field)
            if name == "=head":
                frame = replace(frame, rotation=from_euler(_radians(block[:3])))
                if len(block) == 6:
                    frame = replace(frame, translation=block[3:] * _MILLIMETRES)
            elif name in ("leftEye", "rightEye"):
                gaze[0 if name == "leftEye" else 1] = _radians(block[:3])[:2]
            else:
                name, value = _shape(field)
                if name == "trackingStatus":
                    frame = replace(frame, seen=value > 0.0)
                elif name in _ROW:
                    frame.shapes[_ROW[name]] = value / _PERCENT
                    known += 1
        if not known:
            raise ValueError("no shape that ARKit knows")
        return replace(frame, gaze=gaze)


def _block(field: str) -> tuple[str, Array]:
    """Name and numbers of "name#a,b,c"; an empty name for another field."""
    name, mark, text = field.partition("#")
    if not mark:
        return "", np.zeros(0)
    numbers = np.array([_number(part, _LARGEST_NUMBER) for part in text.split(",")])
    if len(numbers) not in (3, 6):
        raise ValueError(f"{len(numbers)} numbers in {name[:20]}")
    return name, numbers


def _shape(field: str) -> tuple[str, float]:
    """Name and value of "name&value", or of version 1's "name-value"."""
    name, mark, text = field.rpartition("&" if "&" in field else "-")
    return (name, _number(text, _LARGEST_SHAPE)) if mark else ("", 0.0)


def _number(text: str, largest: float) -> float:
    value = float(text)
    if not abs(value) <= largest:
        raise ValueError(f"{text[:20]} is beyond all bounds")
    return value


def _degrees(euler: Array) -> Array:
    """(3,) turns about x, y, z of (yaw, pitch, roll)."""
    yaw, pitch, roll = np.degrees(euler)
    return np.array([-pitch, yaw, -roll])


def _radians(turns: Array) -> Array:
    """(yaw, pitch, roll) of turns (3,) about x, y, z."""
    x, y, z = np.radians(turns)
    return np.array([y, -x, -z])
