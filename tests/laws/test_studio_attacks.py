"""Attacks on the studio, each tried and refused: what is uploaded, who calls, and how fast."""

from __future__ import annotations

import io
import json
import struct
import tempfile
import time
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

pytest.importorskip("starlette", reason="the extra 'studio' is not installed")

from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from clips import quarters
from mien.formats.pictures.jpeg import encode_jpeg
from mien.live.studio.safety import LOOPBACK, Rules
from mien.live.studio.server import studio
from mien.live.studio.shelf import Shelf

PICTURE = struct.pack("<d", 1.0) + encode_jpeg(quarters(640, 480), 480)


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Where the studio keeps things; what it unpacks goes beside it."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    return tmp_path / "shelf"


@pytest.fixture
def client(folder: Path, tmp_path: Path) -> Iterator[TestClient]:
    app = studio(Shelf(folder), Rules(LOOPBACK | {"testserver"}), tmp_path / "no page")
    with TestClient(app, raise_server_exceptions=False) as client:
        yield client


def glb(document: dict[str, object], binary: bytes = b"\0" * 64) -> bytes:
    """A GLB of ``document``, whatever it claims."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = struct.pack("<I4s", len(text), b"JSON") + text
    body += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body


def claiming(accessor: dict[str, object], view: dict[str, object] | None = None) -> bytes:
    """A GLB with one triangle mesh whose vertices are ``accessor``."""
    return glb(
        {
            "asset": {"version": "2.0"},
            "buffers": [{"byteLength": 64}],
            "bufferViews": [{"buffer": 0, "byteLength": 64, **(view or {})}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", **accessor}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "nodes": [{"mesh": 0}],
            "scenes": [{"nodes": [0]}],
        }
    )


def packed(fill: Callable[[zipfile.ZipFile], None]) -> bytes:
    """A ZIP."""
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        fill(archive)
    return file.getvalue()


def zeros(archive: zipfile.ZipFile) -> None:
    with archive.open("huge.glb", "w", force_zip64=True) as stream:
        for _ in range(6):
            stream.write(bytes(1 << 24))


def crowd(archive: zipfile.ZipFile) -> None:
    for number in range(5000):
        archive.writestr(f"{number}.obj", "")


NOTHING = {"count": 4_000_000_000}
BOMBS = {
    "claims.glb": claiming(NOTHING),
    "sparse.glb": claiming(
        {
            "count": 400_000_000,
            "sparse": {
                "count": 1,
                "indices": {"bufferView": 0, "componentType": 5125},
                "values": {"bufferView": 0},
            },
        }
    ),
    "meshopt.glb": claiming(
        {"count": 300_000_000},
        {
            "extensions": {
                "EXT_meshopt_compression": {
                    "buffer": 0,
                    "byteLength": 64,
                    "byteStride": 12,
                    "count": 300_000_000,
                    "mode": "ATTRIBUTES",
                }
            }
        },
    ),
    "itself.glb": glb(
        {
            "asset": {"version": "2.0"},
            "nodes": [{"children": [0]}],
            "scenes": [{"nodes": [0]}],
        }
    ),
    "deep.glb": glb({"asset": {"version": "2.0", "extras": json.loads("[" * 400 + "]" * 400)}}),
    "long.glb": struct.pack("<4sII", b"glTF", 2, 0xFFFFFFFF) + b"\0" * 100,
    "crowd.zip": packed(crowd),
    "outside.zip": packed(lambda archive: archive.writestr("../../evil.glb", b"glTF")),
    "rooted.zip": packed(lambda archive: archive.writestr("/etc/evil.glb", b"glTF")),
    "nested.zip": packed(lambda archive: archive.writestr("a.zip", packed(crowd))),
    "broken.zip": packed(crowd)[:5000],
}


@pytest.mark.parametrize("name", BOMBS)
def test_bombs_are_refused_in_a_line_and_leave_nothing(
    name: str, client: TestClient, folder: Path, tmp_path: Path
) -> None:
    answer = client.put(f"/characters/{name}", content=BOMBS[name])
    told = answer.json()
    assert answer.status_code == 400 or not told["found"]
    assert len(json.dumps(told)) < 500
    assert not list(folder.glob("*.character"))
    assert {path.name for path in tmp_path.iterdir()} <= {"shelf"}


def test_a_zip_that_swells_is_stopped(
    client: TestClient, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("mien.formats.unpack.MAX_BYTES", 1 << 25)
    bomb = packed(zeros)
    assert len(bomb) < 1 << 20
    answer = client.put("/characters/huge.zip", content=bomb)
    assert answer.status_code == 400
    assert "unpacked" in answer.json()["error"]
    assert {path.name for path in tmp_path.iterdir()} <= {"shelf"}


def test_a_performer_that_is_none_is_told(client: TestClient) -> None:
    bomb = packed(lambda archive: archive.writestr("mien.json", b" " * (1 << 26)))
    assert client.put("/performers/her.performer", content=bomb).status_code == 200
    with client.websocket_connect("/live") as socket:
        socket.send_text('{"kind": "Meet", "name": "her.performer"}')
        while True:
            message = json.loads(socket.receive_text())
            if message["kind"] == "Note":
                break
    assert message["level"] == "error"
    assert "her.performer" in message["text"]


@pytest.mark.parametrize(
    "host",
    [
        "evil.example",
        "127.0.0.1.evil.example",
        "evil.example:8765",
        "localhost@evil.example",
        "evil.example#localhost",
        "[::2]:8765",
        "",
        "local host",
    ],
)
def test_a_name_that_was_bound_to_us_is_refused(client: TestClient, host: str) -> None:
    """Rebinding: a page of evil.example whose name now means this machine."""
    assert client.get("/characters/toy.glb", headers={"host": host}).status_code == 403
    put = client.put("/videos/a.mp4", content=b"film", headers={"host": host})
    assert put.status_code == 403
    with (
        pytest.raises(WebSocketDisconnect),
        client.websocket_connect("/live", headers={"host": host}),
    ):
        pass


@pytest.mark.parametrize(
    "origin",
    [
        *("null", "http://evil.example", "https://testserver.evil.example"),
        *("http://testserver:81", "http://localhost", "file://"),
    ],
)
def test_a_page_from_elsewhere_can_neither_see_nor_drive(client: TestClient, origin: str) -> None:
    """Not even one that this machine serves on another port."""
    headers = {"origin": origin}
    assert client.get("/characters/toy.glb", headers=headers).status_code == 403
    assert client.put("/videos/a.mp4", content=b"", headers=headers).status_code == 403
    with pytest.raises(WebSocketDisconnect), client.websocket_connect("/live", headers=headers):
        pass


def test_a_socket_off_the_loopback_needs_the_token(tmp_path: Path) -> None:
    app = studio(Shelf(tmp_path / "shelf"), Rules(frozenset(("testserver",)), "secret"))
    with TestClient(app) as client:
        for address in ("/live", "/live?token=", "/live?token=secre", "/live?token=secrets"):
            with pytest.raises(WebSocketDisconnect), client.websocket_connect(address):
                pass
        with client.websocket_connect("/live?token=secret") as socket:
            assert json.loads(socket.receive_text())["kind"] == "StageSet"


def test_a_flood_of_pictures_is_not_queued(client: TestClient) -> None:
    """Newest wins: what came of a thousand pictures is over soon after the last."""
    with client.websocket_connect("/live") as socket:
        way = {"capture": "snakes", "mapping": "cardinal", "gain": 1.0, "mirror": False}
        socket.send_text(json.dumps({"kind": "Way", **way}))
        socket.send_text('{"kind": "Look", "source": "camera", "name": ""}')
        for _ in range(1000):
            socket.send_bytes(PICTURE)
        time.sleep(0.5)
        socket.send_text('{"kind": "Cast", "characters": ["toy"]}')
        frames = 0
        while True:
            message = socket.receive()
            if message.get("bytes"):
                frames += 1
            elif [a["name"] for a in json.loads(message["text"]).get("actors", ())] == ["toy"]:
                break
    assert frames < 500


def test_pictures_beyond_all_bounds_are_refused(client: TestClient) -> None:
    with client.websocket_connect("/live") as socket:
        for picture in (b"", b"\0" * 8, b"\xff" * 20, bytes((4 << 20) + 1)):
            socket.send_bytes(picture)
            while True:
                message = json.loads(socket.receive_text())
                if message["kind"] == "Note":
                    break
            assert message["level"] == "error"
