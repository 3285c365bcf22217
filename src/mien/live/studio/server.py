"""The studio's server: a page, the characters as files, and one socket a page.

GET  /                       the page
GET  /characters/NAME.glb    a character, its morph targets in the order of the weights
PUT  /characters/FILE        bring a character: says its name, or that nobody's face was found
GET  /models/FILE            a character that was brought, as it is, to point at its features
PUT  /models/FILE/points     ... and the places that were pointed at
GET  /points/NAME.toml       ... as 'mien character import --points' takes them
PUT  /videos/NAME            keep an uploaded video
GET  /videos/NAME            its sound, for the page to play
PUT  /performers/NAME        bring what is known of a performer
GET  /performers/NAME        ... and take it along
PUT  /takes/NAME             bring a take: Live Link CSV, FAP, C3D, TRC, or one of mien's own
GET  /takes/NAME             a take
PUT  /takes/NAME/sound       what was heard while it was recorded
GET  /takes/NAME/sound
GET  /takes/NAME/NAME.KIND   the take acted by a character: GLB, a table, VRMA
GET  /takes/NAME/performance.KIND  the take itself, as others' tools read it
WS   /live                   messages as JSON, pictures in and frames out as bytes
"""

from __future__ import annotations

import asyncio
import json
import tempfile
from collections import deque
from collections.abc import Awaitable, Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict
from pathlib import Path

from starlette.applications import Starlette
from starlette.background import BackgroundTask
from starlette.concurrency import run_in_threadpool
from starlette.exceptions import HTTPException
from starlette.middleware import Middleware
from starlette.requests import ClientDisconnect, Request
from starlette.responses import FileResponse, JSONResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.websockets import WebSocket, WebSocketDisconnect

from mien.errors import InputError, MienError
from mien.formats.save import FOLDERS, SAVERS, save
from mien.live.studio.admission import admit, as_it_is
from mien.live.studio.messages import Note, Told, decode, encode
from mien.live.studio.packet import Answer
from mien.live.studio.safety import Guard, Rules
from mien.live.studio.session import Session
from mien.live.studio.shelf import (
    BROUGHT,
    MODELS,
    PERFORMERS,
    POINTS,
    SOUNDS,
    TAKES,
    VIDEOS,
    Kind,
    Shelf,
)
from mien.live.studio.troupe import Troupe
from mien.performance.performer import Performer
from mien.recipe import WRITERS, animate, save_performance

PAGE = Path(__file__).with_name("page")
"""What Vite built."""
MOST_PAGES = 4
_MOST_WAITING = 64
"""Messages that wait for a page that does not read; frames never wait."""
_LARGEST_NOTE = 1 << 16
EXPORTS = SAVERS.keys() - FOLDERS

Handler = Callable[[Request], Awaitable[Response]]
Picks = Mapping[str, Sequence[float]]


def studio(
    shelf: Shelf, rules: Rules, page: Path = PAGE, performer: Performer | None = None
) -> Starlette:
    """The application; every page begins with ``performer``. Without a built ``page`` it says so
    where the page would be."""
    server = _Server(shelf, performer)
    put = ["PUT"]
    routes = [
        Route("/characters/{name}.glb", server.character, methods=["GET"]),
        Route("/characters/{file}", server.bring, methods=put),
        Route("/models/{file}", server.model),
        Route("/models/{file}/points", server.point, methods=put),
        Route("/points/{file}", server.download(POINTS)),
        Route("/videos/{file}", server.upload(VIDEOS), methods=put),
        Route("/videos/{file}", server.download(VIDEOS)),
        Route("/performers/{file}", server.upload(PERFORMERS), methods=put),
        Route("/performers/{file}", server.download(PERFORMERS)),
        Route("/takes/{take}/sound", server.keep_sound, methods=put),
        Route("/takes/{take}/sound", server.sound),
        Route("/takes/{take}/performance.{kind}", server.told),
        Route("/takes/{take}/{name}.{kind}", server.acted),
        Route("/takes/{file}", server.bring_take, methods=put),
        Route("/takes/{file}", server.download(TAKES)),
        WebSocketRoute("/live", server.live),
    ]
    if (page / "index.html").is_file():
        routes.append(Mount("/", StaticFiles(directory=page, html=True)))
    else:
        routes.append(Route("/", _no_page))
    return Starlette(
        routes=routes,
        middleware=[Middleware(Guard, rules=rules)],
        exception_handlers={MienError: _told, ClientDisconnect: _gone},
    )


async def _no_page(request: Request) -> Response:
    return PlainTextResponse(
        "The studio's page is not built: run 'make studio' in the checkout.\n", 503
    )


async def _told(request: Request, error: Exception) -> Response:
    return JSONResponse({"error": str(error)}, 400)


async def _gone(request: Request, error: Exception) -> Response:
    """Nobody is there any more to be told of an upload that was broken off."""
    return Response(status_code=400)


class _Server:
    def __init__(self, shelf: Shelf, performer: Performer | None) -> None:
        self._shelf, self._troupe, self._performer = shelf, Troupe(shelf), performer
        self._sessions: dict[str, Session] = {}
        self._admitting = asyncio.Lock()

    async def character(self, request: Request) -> Response:
        """A character without a take."""
        name = request.path_params["name"]
        if name not in self._troupe.names():
            raise HTTPException(404)
        body = await run_in_threadpool(self._troupe.still, name)
        return Response(body, media_type="model/gltf-binary")

    async def bring(self, request: Request) -> Response:
        """Somebody's character."""
        path = await self._shelf.keep(request.path_params["file"], MODELS, request.stream())
        return await self._admitted(path.name, None)

    async def model(self, request: Request) -> Response:
        """A character as it was brought."""
        body = await run_in_threadpool(as_it_is, self._shelf, request.path_params["file"])
        return Response(body, media_type="model/gltf-binary")

    async def point(self, request: Request) -> Response:
        """Where the features of a character are."""
        return await self._admitted(request.path_params["file"], await _picks(request))

    async def _admitted(self, model: str, picks: Picks | None) -> Response:
        async with self._admitting:
            admitted = await run_in_threadpool(admit, self._shelf, model, picks)
        return JSONResponse(asdict(admitted))

    def upload(self, kind: Kind) -> Handler:
        """Keep a file of a kind."""

        async def keep(request: Request) -> Response:
            path = await self._shelf.keep(request.path_params["file"], kind, request.stream())
            return JSONResponse({"name": path.name})

        return keep

    def download(self, kind: Kind) -> Handler:
        """Hand out a file of a kind, as it is."""

        async def hand(request: Request) -> Response:
            path = self._shelf.there(request.path_params["file"], kind)
            return FileResponse(path, filename=path.name)

        return hand

    async def bring_take(self, request: Request) -> Response:
        """Somebody's take."""
        path = await self._shelf.keep(request.path_params["file"], BROUGHT, request.stream())
        name = await run_in_threadpool(self._shelf.admit, path.name)
        return JSONResponse({"name": name})

    async def keep_sound(self, request: Request) -> Response:
        """What was heard during a take."""
        path = self._shelf.sound(request.path_params["take"])
        await self._shelf.keep(path.name, SOUNDS, request.stream())
        return JSONResponse({"name": path.name})

    async def sound(self, request: Request) -> Response:
        """The same, to hear it again."""
        path = self._shelf.sound(request.path_params["take"])
        if not path.is_file():
            raise HTTPException(404)
        return FileResponse(path, media_type="audio/wav")

    async def acted(self, request: Request) -> Response:
        """A recording, acted by a character the way a page has it."""
        take, name, kind = (request.path_params[part] for part in ("take", "name", "kind"))
        if f".{kind}" not in EXPORTS or name not in self._troupe.names():
            raise HTTPException(404)
        session = self._sessions.get(request.query_params.get("session", ""))
        path = await run_in_threadpool(self._act, take, name, kind, session)
        return _handed(path, f"{Path(take).stem} {name}{path.suffix}")

    def _act(self, take: str, name: str, kind: str, session: Session | None) -> Path:
        performance, character = self._shelf.take(take), self._troupe.character(name)
        act = session.act if session is not None else animate
        curves = act(performance, character)
        with _temporary(kind) as path:
            return save(curves, path, character)

    async def told(self, request: Request) -> Response:
        """A take itself, in a file of another kind."""
        take, kind = request.path_params["take"], request.path_params["kind"]
        if f".{kind}" not in WRITERS:
            raise HTTPException(404)
        performance = await run_in_threadpool(self._shelf.take, take)
        with _temporary(kind) as path:
            await run_in_threadpool(save_performance, performance, path)
        return _handed(path, f"{Path(take).stem}.{kind}")

    async def live(self, socket: WebSocket) -> None:
        """One page's socket."""
        if len(self._sessions) >= MOST_PAGES:
            await socket.close(4429, f"{MOST_PAGES} pages are open already")
            return
        outbox = _Outbox(asyncio.get_running_loop())
        session = Session(self._shelf, self._troupe, outbox.put, self._performer)
        self._sessions[session.name] = session
        await socket.accept()
        session.start()
        sending = asyncio.create_task(outbox.empty_into(socket))
        try:
            await _listen(socket, session, outbox)
        finally:
            sending.cancel()
            await run_in_threadpool(session.stop)
            del self._sessions[session.name]
            with suppress(RuntimeError, WebSocketDisconnect):
                await socket.close()


@contextmanager
def _temporary(kind: str) -> Iterator[Path]:
    """A file for what is handed out; it goes where the block does not end well."""
    with tempfile.NamedTemporaryFile(suffix=f".{kind}", delete=False) as file:
        path = Path(file.name)
    try:
        yield path
    except BaseException:
        path.unlink(missing_ok=True)
        raise


def _handed(path: Path, name: str) -> Response:
    """A file that goes once it is sent."""
    gone = BackgroundTask(path.unlink, missing_ok=True)
    return FileResponse(path, filename=name, background=gone)


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
    """What waits for a page: of messages a few, of answers to frames the newest."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop
        self._messages: deque[str] = deque(maxlen=_MOST_WAITING)
        self._answer: Answer | None = None
        self._filled = asyncio.Event()

    def put(self, item: Told | Answer) -> None:
        """From any thread."""
        with suppress(RuntimeError):  # the server has gone
            self._loop.call_soon_threadsafe(self._put, item)

    def _put(self, item: Told | Answer) -> None:
        if isinstance(item, Answer):
            self._answer = item
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
                answer, self._answer = self._answer, None
                if answer is not None:
                    await socket.send_bytes(answer.sent())


async def _picks(request: Request) -> Picks:
    """Feature points as a page sends them. Raises InputError."""
    body = b""
    async for chunk in request.stream():
        body += chunk
        if len(body) > _LARGEST_NOTE:
            raise InputError("more points than a face has")
    try:
        told = json.loads(body)["points"]
        return {str(name): [float(x) for x in place] for name, place in told.items()}
    except (LookupError, ValueError, TypeError, AttributeError, RecursionError) as error:
        raise InputError("these are no feature points") from error
