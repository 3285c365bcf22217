"""Datagrams of the Virtual Motion Capture protocol: OSC bundles, port 39539.

Blend shapes under ARKit's names and as VRM 0.x presets, and the bones Head, LeftEye and RightEye.
Its axes are Unity's: left-handed, +y up, +z out of the face, so +x to the subject's right;
mirroring x turns a quaternion (x, y, z, w) into (x, -y, -z, w).
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isfinite
from typing import Any

import numpy as np
from numpy.typing import NDArray
from pythonosc import osc_bundle, osc_message
from pythonosc.osc_bundle import OscBundle
from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message import OscMessage
from pythonosc.osc_message_builder import OscMessageBuilder
from pythonosc.parsing import osc_types

from mien.errors import FormatError
from mien.numeric.rotation import from_gaze, from_quaternion, to_quaternion
from mien.performance.arkit_frame import ArkitFrame
from mien.vocabulary.arkit import names
from mien.vocabulary.vmc import PRESETS, arkit_rows, presets_of, shapes_of, spelled

PORT = 39539
LARGEST_DATAGRAM = 65507

Array = NDArray[np.float64]

_PACKET = 1400
"""Bytes of a bundle: what passes any network whole."""
_UNITY = np.array([1.0, -1.0, -1.0, 1.0])
_EYES = ("LeftEye", "RightEye")
_BLEND, _APPLY, _BONE = "/VMC/Ext/Blend/Val", "/VMC/Ext/Blend/Apply", "/VMC/Ext/Bone/Pos"
_BROKEN = (
    osc_bundle.ParseError,
    osc_message.ParseError,
    osc_types.ParseError,
    struct.error,
    ValueError,
    LookupError,
    OverflowError,
)
"""What python-osc raises on bytes that are no OSC."""
_KNOWN_PRESETS = frozenset(name.lower() for name in PRESETS)


def encode(frame: ArkitFrame) -> list[bytes]:
    """The datagrams that tell ``frame``, to be sent in their order."""
    messages = [
        _message("/VMC/Ext/OK", 1),
        _message("/VMC/Ext/T", float(frame.time)),
        _bone("Head", frame.rotation),
        *(_bone(eye, from_gaze(gaze)) for eye, gaze in zip(_EYES, frame.gaze, strict=True)),
    ]
    weights = dict(zip(spelled(), frame.shapes.tolist(), strict=True))
    weights |= presets_of(frame.shapes, frame.gaze)
    messages += [_message(_BLEND, name, float(weight)) for name, weight in weights.items()]
    return _bundled([*messages, _message(_APPLY)])


class Decoder:
    """Reads a stream, datagram by datagram; a frame is whole when its blend shapes are applied.
    What a sender leaves out keeps its last value."""

    def __init__(self) -> None:
        self._shapes: dict[str, float] = {}
        self._last = ArkitFrame(0.0, np.zeros(len(names())))

    def decode(self, datagram: bytes, time: float = 0.0) -> list[ArkitFrame]:
        """Frames completed by ``datagram``, received at ``time``. Messages that are not about a
        face are passed over. Raises FormatError."""
        if len(datagram) > LARGEST_DATAGRAM:
            raise FormatError(f"not a VMC datagram ({len(datagram)} bytes)")
        try:
            messages = list(_messages(datagram))
        except _BROKEN as error:
            raise FormatError("not a VMC datagram: these bytes are no OSC") from error
        done = []
        for address, arguments in messages:
            if address == _APPLY:
                self._last = replace(self._last, time=time, shapes=self._applied())
                done.append(self._last)
            elif address == _BLEND and _are(arguments, str, float):
                self._blend(*arguments)
            elif address == _BONE and _are(arguments, str, *[float] * 7):
                self._turn(arguments[0], np.array(arguments[4:]))
        return done

    def _blend(self, name: str, weight: float) -> None:
        name = name.lower()
        if name in arkit_rows() or name in _KNOWN_PRESETS:
            self._shapes[name] = min(max(weight, 0.0), 1.0)

    def _applied(self) -> Array:
        rows = {
            row: self._shapes[name] for name, row in arkit_rows().items() if name in self._shapes
        }
        if not rows:
            return shapes_of(self._shapes)
        shapes = np.zeros(len(names()))
        shapes[list(rows)] = list(rows.values())
        return shapes

    def _turn(self, bone: str, quaternion: Array) -> None:
        if not 0.5 < np.linalg.norm(quaternion) < 2.0:
            return
        rotation = from_quaternion(quaternion * _UNITY)
        if bone == "Head":
            self._last = replace(self._last, rotation=rotation)
        elif bone in _EYES:
            gaze = self._last.gaze.copy()
            ahead = rotation[:, 2]
            gaze[_EYES.index(bone)] = np.arctan2(ahead[0], ahead[2]), np.arcsin(ahead[1])
            self._last = replace(self._last, gaze=gaze)


def _bone(name: str, rotation: Array) -> OscMessage:
    return _message(_BONE, name, 0.0, 0.0, 0.0, *(to_quaternion(rotation) * _UNITY).tolist())


def _message(address: str, *arguments: str | float) -> OscMessage:
    builder = OscMessageBuilder(address)
    for argument in arguments:
        builder.add_arg(argument)
    return builder.build()


def _bundled(messages: Sequence[OscMessage]) -> list[bytes]:
    packets, builder, size = [], OscBundleBuilder(IMMEDIATELY), 16
    for message in messages:
        if size + message.size + 4 > _PACKET:
            packets.append(builder.build().dgram)
            builder, size = OscBundleBuilder(IMMEDIATELY), 16
        builder.add_content(message)
        size += message.size + 4
    return [*packets, builder.build().dgram]


def _messages(datagram: bytes) -> Iterator[tuple[str, list[Any]]]:
    if not OscBundle.dgram_is_bundle(datagram):
        message = OscMessage(datagram)
        yield message.address, list(message.params)
        return
    waiting: list[OscBundle | OscMessage] = [OscBundle(datagram)]
    while waiting:
        content = waiting.pop(0)
        if isinstance(content, OscBundle):
            waiting[:0] = list(content)
        else:
            yield content.address, list(content.params)


def _are(arguments: list[Any], *kinds: type) -> bool:
    """Whether the first arguments are of these kinds, and every number is one."""
    return len(arguments) >= len(kinds) and all(
        isinstance(argument, kind) and (not isinstance(argument, float) or isfinite(argument))
        for argument, kind in zip(arguments, kinds, strict=False)
    )
