"""Where a live face comes from, when it comes over the network."""

from __future__ import annotations

import socket
from collections.abc import Callable, Iterator, Mapping
from threading import Event
from time import perf_counter

from mien.errors import FormatError, InputError
from mien.formats.streams import ifacialmocap, livelink, vmc
from mien.performance.arkit_frame import ArkitFrame

Decode = Callable[[bytes, float], list[ArkitFrame]]
"""Frames that are whole with this datagram, received at that time."""

_LARGEST = 65535
_PATIENCE = 0.2
"""Seconds between two looks at whether somebody wants to stop."""


def _livelink(swap: bool) -> Decode:
    decoder = livelink.Decoder(swap)
    return lambda datagram, time: [decoder.decode(datagram)]


def _ifacialmocap(swap: bool) -> Decode:
    decoder = ifacialmocap.Decoder()
    return lambda datagram, time: [decoder.decode(datagram, time)]


def _vmc(swap: bool) -> Decode:
    return vmc.Decoder().decode


INPUTS: Mapping[str, tuple[Callable[[bool], Decode], int, bytes | None]] = {
    "livelink": (_livelink, livelink.PORT, None),
    "ifacialmocap": (_ifacialmocap, ifacialmocap.PORT, ifacialmocap.HELLO),
    "vmc": (_vmc, vmc.PORT, None),
}
"""How a protocol is read, its usual port, and what its sender must be told before it sends."""


class Receiver:
    """A socket on which a face is heard. Datagrams that are none are counted and passed over."""

    def __init__(
        self,
        protocol: str,
        host: str,
        port: int,
        *,
        swap_sideways: bool = False,
        wake: str | None = None,
    ) -> None:
        """Listens on ``host`` and ``port``. ``wake`` is the address of a phone that must be told
        to begin (iFacialMocap). Raises KeyError for an unknown protocol, InputError where nobody
        may listen."""
        build, _, hello = INPUTS[protocol]
        self._decode = build(swap_sideways)
        self._stop = Event()
        self.refused = 0
        try:
            family = socket.getaddrinfo(host, port, type=socket.SOCK_DGRAM)[0][0]
            self._socket = socket.socket(family, socket.SOCK_DGRAM)
            self._socket.bind((host, port))
        except OSError as error:
            raise InputError(
                f"cannot listen on {host}:{port} ({error.strerror}); is another program there?"
            ) from error
        self._socket.settimeout(_PATIENCE)
        if wake is not None and hello is not None:
            self._socket.sendto(hello, (wake, port))

    @property
    def port(self) -> int:
        """The port that is listened on."""
        return int(self._socket.getsockname()[1])

    def __iter__(self) -> Iterator[ArkitFrame]:
        begin = perf_counter()
        try:
            while not self._stop.is_set():
                try:
                    datagram = self._socket.recv(_LARGEST)
                    yield from self._decode(datagram, perf_counter() - begin)
                except TimeoutError:
                    continue
                except FormatError:
                    self.refused += 1
        finally:
            self._socket.close()

    def stop(self) -> None:
        """End the iteration soon."""
        self._stop.set()
