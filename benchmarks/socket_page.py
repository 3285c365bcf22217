"""A page without a browser: the studio in a process of its own, and a socket to it."""

from __future__ import annotations

import json
import re
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from threading import Lock

from wsproto import ConnectionType, WSConnection
from wsproto.events import (
    AcceptConnection,
    BytesMessage,
    CloseConnection,
    Ping,
    Request,
    TextMessage,
)
from wsproto.utilities import RemoteProtocolError

_CHUNK = 1 << 16


@dataclass(frozen=True)
class Studio:
    """``mien studio``, running."""

    process: subprocess.Popen[str]
    port: int


@contextmanager
def running_studio(folder: Path) -> Iterator[Studio]:
    """A studio that keeps its files in ``folder``, on a port of its own."""
    mien = Path(sys.executable).with_name("mien")
    command = [str(mien), "studio", "--no-browser", "--port", "0", "--folder", str(folder)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout is not None
        address = re.search(r"http://127\.0\.0\.1:(\d+)/", process.stdout.readline())
        if address is None:
            raise SystemExit("the studio did not start")
        yield Studio(process, int(address[1]))
    finally:
        process.terminate()
        process.wait(60)


class Page:
    """What a page says and hears."""

    def __init__(self, port: int, patience: float = 30.0) -> None:
        """``patience`` in seconds of silence. Raises OSError where nobody listens."""
        self._socket = socket.create_connection(("127.0.0.1", port), timeout=patience)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._protocol = WSConnection(ConnectionType.CLIENT)
        self._lock = Lock()
        self._send(Request(host=f"127.0.0.1:{port}", target="/live"))
        self.open = False
        for _ in self._events():
            if self.open:
                return
        raise OSError("the studio let nobody in")

    def say(self, message: dict[str, object]) -> None:
        """Send a message. Raises OSError where the studio has gone."""
        self.say_raw(json.dumps(message))

    def say_raw(self, text: str) -> None:
        """Send anything as text."""
        self._send(TextMessage(text))

    def show(self, picture: bytes) -> None:
        """Send bytes."""
        self._send(BytesMessage(picture))

    def hear(self) -> Iterator[bytes | str]:
        """What comes, until the studio ends it. Raises OSError after a silence."""
        text, data = "", b""
        for event in self._events():
            if isinstance(event, BytesMessage | TextMessage):
                if isinstance(event, TextMessage):
                    text += event.data
                else:
                    data += event.data
                if event.message_finished:
                    yield text if isinstance(event, TextMessage) else data
                    text, data = "", b""

    def go(self, politely: bool = True) -> None:
        """Leave, with or without saying so."""
        if politely and self.open:
            self._send(CloseConnection(code=1000))
        self.open = False
        self._socket.close()

    def _send(self, event: object) -> None:
        with self._lock:
            self._socket.sendall(self._protocol.send(event))  # type: ignore[arg-type]

    def _events(self) -> Iterator[object]:
        while True:
            data = self._socket.recv(_CHUNK)
            try:
                with self._lock:
                    self._protocol.receive_data(data or None)
                    events = list(self._protocol.events())
            except RemoteProtocolError:
                return
            for event in events:
                if isinstance(event, AcceptConnection):
                    self.open = True
                elif isinstance(event, Ping):
                    self._send(event.response())
                elif isinstance(event, CloseConnection):
                    self.open = False
                    return
                yield event
            if not data:
                return
