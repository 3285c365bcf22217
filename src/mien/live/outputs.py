"""Where a live face is sent: a protocol a name."""

from __future__ import annotations

import socket
from collections.abc import Callable, Mapping, Sequence

from mien.errors import InputError
from mien.formats.streams import ifacialmocap, livelink, openseeface, vmc
from mien.live.openseeface import seen_face
from mien.performance.arkit_frame import ArkitFrame

Encode = Callable[[ArkitFrame, int], Sequence[bytes]]
"""Datagrams of the n-th frame of a stream."""


def _livelink(frame: ArkitFrame, number: int) -> list[bytes]:
    return [livelink.encode(frame, number)]


def _ifacialmocap(frame: ArkitFrame, number: int) -> list[bytes]:
    return [ifacialmocap.encode(frame)]


def _openseeface(frame: ArkitFrame, number: int) -> list[bytes]:
    return [openseeface.encode(seen_face(frame))]


def _vmc(frame: ArkitFrame, number: int) -> list[bytes]:
    return vmc.encode(frame)


OUTPUTS: Mapping[str, tuple[Encode, int]] = {
    "vmc": (_vmc, vmc.PORT),
    "livelink": (_livelink, livelink.PORT),
    "ifacialmocap": (_ifacialmocap, ifacialmocap.PORT),
    "openseeface": (_openseeface, openseeface.PORT),
}
"""How a frame is said, and the port where it is usually listened to."""


class Sender:
    """One listener somewhere. Nobody need be there."""

    def __init__(self, protocol: str, host: str, port: int) -> None:
        """Raises KeyError for an unknown protocol, InputError for a host nobody knows."""
        self._encode, _ = OUTPUTS[protocol]
        try:
            family, kind, _, _, where = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0]
        except OSError as error:
            raise InputError(f"--{protocol} {host}:{port}: no such address") from error
        self._address = where
        self._socket = socket.socket(family, kind)
        self._socket.setblocking(False)
        self._number = 0

    def send(self, frame: ArkitFrame) -> None:
        """Say ``frame``. What the network does not take at once is gone: newer frames come."""
        for datagram in self._encode(frame, self._number):
            try:
                self._socket.sendto(datagram, self._address)
            except OSError:
                break
        self._number += 1

    def close(self) -> None:
        """Give the socket back."""
        self._socket.close()


def address(text: str, usual: int) -> tuple[str, int]:
    """Host and port of "host:port", "host", ":port" or "[::1]:port". Raises ValueError."""
    host, colon, port = text.rpartition(":")
    if not colon or (text.startswith("[") and text.endswith("]")):
        host, port = text, str(usual)
    number = int(port)
    if not 0 < number < 65536:
        raise ValueError(f"{port} is no port")
    return host.strip("[]") or "127.0.0.1", number
