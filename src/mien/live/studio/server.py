"""The studio's server: a page, the characters as files, and one socket a page.

GET  /                       the page
GET  /characters/NAME.glb    a character, its morph targets in the order of the weights
PUT  /videos/NAME            keep an uploaded video
GET  /takes/NAME             a recorded take
GET  /takes/NAME/NAME.glb    the take acted by a character
WS   /live                   messages as JSON, pictures in and frames out as bytes
"""

from __future__ import annotations

import asyncio
import tempfile
from collections import deque
from contextlib import suppress
from functools import lru_cache
from pathlib import Path

from starlette.applications import Starlette
from starlette.background import BackgroundTask
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.middleware import Middleware
from starlette.requests import Request
from starlette.responses import FileResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from mien.errors import MienError
from mien.face.library import CHARACTERS, load_character
from mien.face.pieces import split
from mien.formats.gltf.glb import write_glb
from mien.live.studio.messages import Note, StageSet, decode, encode
from mien.live.studio.safety import Guard, Rules
from mien.live.studio.session import Session
from mien.live.studio.shelf import Shelf
from mien.recipe import animate

PAGE = Path(__file__).with_name("page")
"""What Vite built."""
MOST_PAGES = 4
_MOST_WAITING = 64
"""Messages that wait for a page that does not read; frames never wait."""


def studio(shelf: Shelf, rules: Rules, page: Path = PAGE) -> Starlette:
    """The application. Without a built ``page`` it says so where the page would be."""
    server = _Server(shelf)
    routes = [
        Route("/characters/{name}.glb", server.character),
        Route("/videos/{name}", server.upload, methods=["PUT"]),
        Route("/takes/{take}/{name}.glb", server.acted),
        Route("/takes/{take}", server.take),
        WebSocketRoute("/live", server.live),
    ]
    if (page / "index.html").is_file():
        routes.append(Mount("/", StaticFiles(directory=page, html=True)))
    else:
        routes.append(Route("/", _no_page))
    return Starlette(
        routes=routes,
        middleware=[Middleware(Guard, rules=rules)],
        exception_handlers={MienError: _told},
    )


async def _no_page(request: Request) -> Response:
    return PlainTextResponse(
        "The studio's page is not built: run 'make studio' in the checkout.\n", 503
    )


async def _told(request: Request, error: Exception) -> Response:
    return JSONResponse({"error": str(error)}, 400)


class _Server:
    def __init__(self, shelf: Shelf) -> None:
        self._shelf = shelf
        self._open = 0

    async def character(self, request: Request) -> Response:
        """A character without a take."""
        name = _cast(request)
        return Response(await run_in_threadpool(_still, name), media_type="model/gltf-binary")

    async def upload(self, request: Request) -> Response:
        """Keep a video."""
        path = await self._shelf.keep(request.path_params["name"], request.stream())
        return JSONResponse({"name": path.name})

    async def take(self, request: Request) -> Response:
        """A recording as it was written."""
        name = request.path_params["take"]
        await run_in_threadpool(self._shelf.take, name)
        return FileResponse(self._shelf.folder / name, filename=name)

    async def acted(self, request: Request) -> Response:
        """A recording, acted by a character."""
        name, take = _cast(request), request.path_params["take"]
        path = await run_in_threadpool(self._act, take, name)
        return FileResponse(
            path,
            media_type="model/gltf-binary",
            filename=f"{Path(take).stem} {name}.glb",
            background=BackgroundTask(path.unlink, missing_ok=True),
        )

    def _act(self, take: str, name: str) -> Path:
        character = load_character(name)
        curves = animate(self._shelf.take(take), character)
        with tempfile.NamedTemporaryFile(suffix=".glb", delete=False) as file:
            path = Path(file.name)
        write_glb(path, character, curves)
        return path

    async def live(self, socket: WebSocket) -> None:
        """One page's socket."""
        if self._open >= MOST_PAGES:
            await socket.close(4429, f"{MOST_PAGES} pages are open already")
            return
        await socket.accept()
        self._open += 1
        outbox = _Outbox(asyncio.get_running_loop())
        session = Session(self._shelf, outbox.put)
        session.start()
        sending = asyncio.create_task(outbox.empty_into(socket))
        try:
            await _listen(socket, session, outbox)
        finally:
            sending.cancel()
            await run_in_threadpool(session.stop)
            self._open -= 1
            with suppress(RuntimeError, WebSocketDisconnect):
                await socket.close()


async def _listen(socket: WebSocket, session: Session, outbox: _Outbox) -> None:
    """Hand on what a page says until it goes, or says what cannot be meant."""
    with suppress(WebSocketDisconnect):
        while True:
            told = await socket.receive()
            if told["type"] == "websocket.disconnect":
                return
            try:
                if told.get("bytes") is not None:
                    session.see(told["bytes"])
                else:
                    session.hear(decode(told["text"]))
            except (MienError, ValueError) as error:
                outbox.put(Note(str(error), "error"))


class _Outbox:
    """What waits for a page: of messages a few, of frames the newest."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._messages: deque[str] = deque(maxlen=_MOST_WAITING)
        self._frame: bytes | None = None
        self._filled = asyncio.Event()

    def put(self, item: StageSet | Note | bytes) -> None:
        """From any thread."""
        with suppress(RuntimeError):  # the server has gone
            self._loop.call_soon_threadsafe(self._put, item)

    def _put(self, item: StageSet | Note | bytes) -> None:
        if isinstance(item, bytes):
            self._frame = item
        else:
            self._messages.append(encode(item))
        self._filled.set()

    async def empty_into(self, socket: WebSocket) -> None:
        """Send, for as long as the page reads."""
        with suppress(WebSocketDisconnect, RuntimeError):
            while True:
                await self._filled.wait()
                self._filled.clear()
                while self._messages:
                    await socket.send_text(self._messages.popleft())
                frame, self._frame = self._frame, None
                if frame is not None:
                    await socket.send_bytes(frame)


def _cast(request: Request) -> str:
    name: str = request.path_params["name"]
    if name not in CHARACTERS:
        raise HTTPException(404)
    return name


@lru_cache(maxsize=len(CHARACTERS))
def _still(name: str) -> bytes:
    """A character's GLB whose morph targets are its pieces."""
    character = load_character(name)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.glb"
        write_glb(path, character, names=split(character).names)
        return path.read_bytes()
