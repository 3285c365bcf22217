"""The studio: a page in the browser on which you act and characters follow.

Serves this machine alone unless --host says otherwise; then only those who bring the token.
"""

from __future__ import annotations

import argparse
import secrets
import socket
import webbrowser
from pathlib import Path

from mien.errors import InputError, MissingExtraError

_LARGEST_MESSAGE = 8 * 2**20
_FAREWELL = 3
"""Seconds for which an end waits for pages; one that does not read would keep it for ever."""


def configure(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--host", default="127.0.0.1", help="address to serve on (%(default)s)")
    parser.add_argument("--port", type=int, default=8765, help="port (%(default)s)")
    parser.add_argument(
        "--folder",
        type=Path,
        default=Path("mien-studio"),
        help="where uploaded videos and recorded takes are kept (%(default)s)",
    )
    parser.add_argument(
        "--performer",
        type=Path,
        metavar="FILE.performer",
        help="what is known of the performer (see 'mien calibrate')",
    )
    parser.add_argument("--no-browser", action="store_true", help="open no browser")


def run(options: argparse.Namespace) -> None:
    try:
        import uvicorn

        from mien.capture.detector import WITHOUT, installed
        from mien.formats.performer_file import read_performer
        from mien.live.studio.safety import LOOPBACK, Rules
        from mien.live.studio.server import studio
        from mien.live.studio.shelf import Shelf
    except ImportError as error:
        raise MissingExtraError("mien studio", "studio") from error
    local = options.host in LOOPBACK
    rules = Rules(
        hosts=LOOPBACK if local else LOOPBACK | {options.host},
        token="" if local else secrets.token_urlsafe(24),
    )
    known = None if options.performer is None else read_performer(options.performer)
    app = studio(Shelf(options.folder), rules, performer=known)
    door = _bound(options.host, options.port)
    address = _address(options.host, door.getsockname()[1], rules.token)
    print(f"the studio is at {address} (Ctrl-C ends it)", flush=True)
    if not installed():
        print(WITHOUT, flush=True)
    if not options.no_browser:
        webbrowser.open(address)
    config = uvicorn.Config(
        app,
        log_level="error",
        ws="wsproto",
        ws_max_size=_LARGEST_MESSAGE,
        timeout_graceful_shutdown=_FAREWELL,
    )
    uvicorn.Server(config).run(sockets=[door])


def _bound(host: str, port: int) -> socket.socket:
    """A listening socket. Raises InputError where somebody else listens."""
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        # Named, asyncio knows it for TCP and lets small messages go at once; otherwise weights
        # wait until the page has acknowledged the last ones, which it does with its next picture.
        door = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
        door.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        door.bind((host, port))
        door.listen()
    except (OSError, OverflowError) as error:
        reason = getattr(error, "strerror", None) or error
        raise InputError(
            f"--host {host} --port {port}: cannot listen there ({reason}); try another port"
        ) from error
    return door


def _address(host: str, port: int, token: str) -> str:
    name = f"[{host}]" if ":" in host else host
    return f"http://{name}:{port}/" + (f"?token={token}" if token else "")
