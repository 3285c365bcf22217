"""The studio's server: what the page and it say, and what it refuses."""

from __future__ import annotations

import asyncio
import json
import socket
import struct
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import asdict
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the extra 'studio' is not installed")

from starlette.testclient import TestClient, WebSocketTestSession
from starlette.websockets import WebSocketDisconnect

from mien.cli.studio import _bound
from mien.errors import InputError, OutputError
from mien.face.library import load_character
from mien.formats.pictures.jpeg import encode_jpeg
from mien.formats.takes.recording import Recorder
from mien.live.studio import messages, packet
from mien.live.studio.adjust import Desk
from mien.live.studio.messages import Adjust, Note, decode, encode
from mien.live.studio.safety import LOOPBACK, Rules
from mien.live.studio.server import MOST_PAGES, studio
from mien.live.studio.shelf import VIDEOS, Shelf
from mien.live.studio.sources import PageCamera
from mien.live.studio.troupe import targets
from mien.performance.arkit_frame import ArkitFrame, performance_of
from mien.performance.performance import Performance
from mien.performance.performer import HeldFace, Performer
from mien.recipe import animate
from mien.vocabulary.arkit import names

STUDIO = Path(__file__).parents[2] / "studio"


@pytest.fixture
def client(shelf: Shelf, tmp_path: Path) -> Iterator[TestClient]:
    app = studio(shelf, Rules(LOOPBACK | {"testserver"}), tmp_path)
    with TestClient(app, raise_server_exceptions=False) as client:
        yield client


def smiling(frames: int = 20) -> Performance:
    shapes = np.zeros((frames, 52))
    shapes[:, names().index("mouthSmileLeft")] = np.linspace(0.0, 0.9, frames)
    return performance_of([ArkitFrame(i / 30, row) for i, row in enumerate(shapes)], "a test")


def recorded(shelf: Shelf) -> str:
    path = shelf.new_take()
    recorder = Recorder(path, smiling())
    recorder.write(smiling())
    recorder.close()
    return path.name


def told(socket: WebSocketTestSession, kind: str) -> dict[str, object]:
    """The next message of a kind; frames and others are passed over."""
    while True:
        message = socket.receive()
        if message.get("text") and json.loads(message["text"])["kind"] == kind:
            found: dict[str, object] = json.loads(message["text"])
            return found


def test_types_of_the_page_are_those_of_the_server() -> None:
    written = (STUDIO / "src" / "messages.ts").read_text(encoding="utf-8")
    assert written == messages.typescript(), "run 'make studio'"


def test_messages_come_back() -> None:
    adjust = Adjust("man", "smile_mouth_L", 1.5, False, None)
    assert decode(json.dumps({"kind": "Adjust", **asdict(adjust)})) == adjust
    assert json.loads(encode(Note("a", "info"))) == {"kind": "Note", "text": "a", "level": "info"}


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "null",
        '{"kind": "Nothing"}',
        '{"kind": "Forget", "number": 1, "more": 1}',
        '{"kind": "Seek", "time": "soon", "playing": true}',
        '{"kind": "Seek", "time": 1e300, "playing": true}',
        '{"kind": "Cast", "characters": "man"}',
        json.dumps({"kind": "Cast", "characters": ["a"] * 1000}),
        '{"kind": "Look", "source": "elsewhere", "name": ""}',
        "[" * 100_000,
    ],
)
def test_messages_that_are_none_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"\w"):
        decode(text)


def test_a_packet_says_its_own_layout() -> None:
    toy = load_character("toy")
    curves = animate(smiling(), toy)
    body = packet.packet(
        [packet.moment(1.5, 7.0, "following"), packet.character(3, curves, targets(toy))]
    )
    sections = dict(packet.unpack(body))
    assert struct.unpack("<dfI", sections["MOMT"]) == (1.5, 7.0, 1)
    numbers = np.frombuffer(sections["C003"], "<f4")
    assert len(numbers) == 15 + len(targets(toy))
    row = curves.names.index("smile_mouth_L")
    said = numbers[15 + targets(toy).index("smile_mouth_L")]
    assert said == pytest.approx(curves.weights[0, row], abs=1e-6)
    np.testing.assert_allclose(numbers[:4], [0, 0, 0, 1], atol=1e-6)
    with pytest.raises(ValueError, match="longer"):
        list(packet.unpack(body[:-1]))


def test_weights_are_pinned_muted_and_made_louder() -> None:
    toy = load_character("toy")
    curves = animate(smiling(), toy)
    target = curves.names[int(np.argmax(curves.weights[-1]))]
    row = curves.names.index(target)
    desk = Desk()
    for gain, muted, pinned, expected in (
        (0.5, False, None, 0.5 * curves.weights[-1, row]),
        (1.0, True, None, 0.0),
        (1.0, False, 0.3, 0.3),
        (1.0, False, None, curves.weights[-1, row]),
    ):
        desk.set(Adjust("toy", target, gain, muted, pinned))
        assert desk({"toy": curves})["toy"].weights[-1, row] == pytest.approx(expected)


def test_a_page_plays_a_take_and_exports_it(client: TestClient, shelf: Shelf) -> None:
    name = recorded(shelf)
    with client.websocket_connect("/live") as socket:
        stage = told(socket, "StageSet")
        assert stage["takes"] == [name]
        socket.send_text(json.dumps({"kind": "Look", "source": "take", "name": name}))
        socket.send_text(json.dumps({"kind": "Seek", "time": 99.0, "playing": False}))
        weights = np.zeros(0)
        for _ in range(200):
            message = socket.receive()
            if message.get("bytes") is None:
                continue
            sections = dict(packet.unpack(message["bytes"]))
            place, length = struct.unpack("<dd", sections["PLAY"])
            weights = np.frombuffer(sections["C000"], "<f4")[15:]
            if place == length:
                break
    man = load_character("man")
    smile = weights[targets(man).index("smile_mouth_L")]
    assert smile > 0.3
    glb = client.get(f"/takes/{name}/man.glb")
    assert glb.status_code == 200
    assert glb.content[:4] == b"glTF"


def test_what_is_exported_is_what_the_page_shows(client: TestClient, shelf: Shelf) -> None:
    address = f"/takes/{recorded(shelf)}/woman.csv"

    def smile(session: str) -> float:
        head, *rows = client.get(f"{address}?session={session}").text.splitlines()
        return float(rows[-1].split(",")[head.split(",").index("smile_mouth_L")])

    with client.websocket_connect("/live") as socket:
        session = str(told(socket, "StageSet")["session"])
        adjust = Adjust("woman", "smile_mouth_L", 1.0, False, 0.123)
        socket.send_text(json.dumps({"kind": "Adjust", **asdict(adjust)}))
        socket.send_text('{"kind": "Cast", "characters": ["woman"]}')
        told(socket, "StageSet")
        assert smile(session) == pytest.approx(0.123)
    assert smile(session) > 0.3


def test_an_export_that_fails_leaves_nothing(
    client: TestClient, shelf: Shelf, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(*_: object) -> Path:
        raise OutputError("the disk is full")

    name, room = recorded(shelf), tmp_path / "room"
    room.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(room))
    monkeypatch.setattr("mien.live.studio.server.save", full)
    monkeypatch.setattr("mien.live.studio.server.save_performance", full)
    for export in (f"{name}/man.csv", f"{name}/performance.fap", "none.mien/performance.fap"):
        assert client.get(f"/takes/{export}").status_code >= 400
    assert list(room.iterdir()) == []


def test_a_page_that_errs_is_told_and_may_go_on(client: TestClient) -> None:
    with client.websocket_connect("/live") as socket:
        told(socket, "StageSet")
        for text in (
            "{",
            '{"kind": "Look", "source": "video", "name": "../../secret.mp4"}',
            '{"kind": "Cast", "characters": ["somebody"]}',
        ):
            socket.send_text(text)
            assert told(socket, "Note")["level"] == "error"
        socket.send_bytes(b"no picture")
        assert told(socket, "Note")["level"] == "error"
        socket.send_text('{"kind": "Cast", "characters": ["toy"]}')
        actors = told(socket, "StageSet")["actors"]
        assert [actor["name"] for actor in actors] == ["toy"]


def test_characters_come_with_the_targets_of_their_weights(client: TestClient) -> None:
    answer = client.get("/characters/toy.glb")
    assert answer.content[:4] == b"glTF"
    assert client.get("/characters/nobody.glb").status_code == 404
    size = struct.unpack_from("<I", answer.content, 12)[0]
    document = json.loads(answer.content[20 : 20 + size])
    named = [mesh["extras"]["targetNames"] for mesh in document["meshes"] if "extras" in mesh]
    assert set().union(*named) == set(targets(load_character("toy")))


def test_only_this_host_and_this_page_are_answered(client: TestClient) -> None:
    assert client.get("/characters/toy.glb", headers={"host": "evil.example"}).status_code == 403
    foreign = client.get("/characters/toy.glb", headers={"origin": "http://evil.example"})
    assert foreign.status_code == 403
    with (
        pytest.raises(WebSocketDisconnect),
        client.websocket_connect("/live", headers={"origin": "http://evil.example"}),
    ):
        pass
    answer = client.get("/characters/toy.glb")
    assert answer.headers["cross-origin-resource-policy"] == "same-origin"
    assert "access-control-allow-origin" not in answer.headers


def test_off_the_loopback_a_token_is_asked_for(shelf: Shelf, tmp_path: Path) -> None:
    app = studio(shelf, Rules(frozenset(("testserver",)), token="secret"), tmp_path)
    with TestClient(app) as client:
        assert client.get("/characters/toy.glb").status_code == 403
        assert client.get("/characters/toy.glb?token=wrong").status_code == 403
        first = client.get("/characters/toy.glb?token=secret")
        assert first.status_code == 200
        assert "HttpOnly" in first.headers["set-cookie"]
        # The cookie that came with it is enough from now on.
        assert client.get("/characters/toy.glb").status_code == 200


@pytest.mark.parametrize(
    "name", ["..%2f..%2fsecret.take", "%2e%2e%2fsecret.take", ".take", "a.txt", "a%00.take"]
)
def test_names_do_not_lead_out_of_the_folder(client: TestClient, name: str, shelf: Shelf) -> None:
    (shelf.folder.parent / "secret.take").write_bytes(b"secret")
    answer = client.get(f"/takes/{name}")
    assert answer.status_code in (400, 404)
    assert answer.content != b"secret"


def test_uploads_are_kept_whole_or_not_at_all(
    client: TestClient, shelf: Shelf, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert client.put("/videos/a.mp4", content=b"film").json() == {"name": "a.mp4"}
    assert (shelf.folder / "a.mp4").read_bytes() == b"film"
    assert client.put("/videos/a.exe", content=b"film").status_code == 400
    monkeypatch.setattr("mien.live.studio.shelf.LARGEST_VIDEO", 20)
    monkeypatch.setattr("mien.live.studio.shelf.LARGEST_FILE", 10)
    assert client.put("/videos/b.mp4", content=b"film" * 10).status_code == 400
    assert client.put("/characters/b.glb", content=b"film" * 4).status_code == 400
    assert [path.name for path in shelf.folder.iterdir()] == ["a.mp4"]


def test_small_messages_go_at_once() -> None:
    """Otherwise weights wait until a page has acknowledged the last ones."""

    async def delayed() -> bool:
        answered: list[socket.socket] = []
        door = _bound("127.0.0.1", 0)
        server = await asyncio.start_server(
            lambda _, writer: answered.append(writer.get_extra_info("socket")), sock=door
        )
        async with server:
            _, writer = await asyncio.open_connection(*door.getsockname())
            while not answered:
                await asyncio.sleep(0.01)
            writer.close()
            return not answered[0].getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)

    assert not asyncio.run(delayed())


def test_there_is_room_for_a_few_pages(client: TestClient) -> None:
    with ExitStack() as stack:
        for _ in range(MOST_PAGES):
            stack.enter_context(client.websocket_connect("/live"))
        with pytest.raises(WebSocketDisconnect), client.websocket_connect("/live"):
            pass


def test_a_flood_is_refused_and_forgiven(client: TestClient) -> None:
    with client.websocket_connect("/live") as socket:
        told(socket, "StageSet")
        for _ in range(2000):
            socket.send_text('{"kind": "Seek", "time": 0, "playing": true}')
        socket.send_text('{"kind": "Cast", "characters": ["woman"]}')
        for _ in range(20):
            time.sleep(0.05)
            socket.send_text('{"kind": "Cast", "characters": ["woman"]}')
        assert [actor["name"] for actor in told(socket, "StageSet")["actors"]] == ["woman"]


def test_a_picture_that_comes_after_a_later_one_is_passed_over() -> None:
    camera = PageCamera()
    grey = encode_jpeg(np.full((8, 8, 3), 128, np.uint8), 8)
    camera.put(2.0, grey)
    camera.put(1.9, grey)
    camera.put(2.0, grey)
    arrived = camera.next(0.1)
    assert arrived is not None
    assert arrived.item.time == 2.0
    assert camera.next(0.01) is None


def test_a_shelf_has_names_only_for_what_it_keeps(shelf: Shelf) -> None:
    for name in ("../a.mp4", "/etc/passwd", "a/b.mp4", "", "x" * 300 + ".mp4"):
        with pytest.raises(InputError):
            shelf.there(name, VIDEOS)


def test_without_the_networks_a_page_begins_with_the_curves_and_says_so(
    client: TestClient, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in ("mien.capture.stepping", "mien.live.studio.session"):
        monkeypatch.setattr(sys.modules[module], "installed", lambda: False)
    with client.websocket_connect("/live") as socket:
        stage = told(socket, "StageSet")
        assert stage["captures"] == ["snakes"]
        assert stage["way"]["capture"] == "snakes"
        assert "not installed" in told(socket, "Note")["text"]
        way = {"capture": "landmarks", "mapping": "cardinal", "gain": 1.0, "mirror": False}
        socket.send_text(json.dumps({"kind": "Way", **way}))
        assert told(socket, "Note")["level"] == "error"


def test_every_page_begins_with_the_performer_that_is_known(shelf: Shelf, tmp_path: Path) -> None:
    face = HeldFace("landmarks", "", {"smile": 1.0}, np.ones((3, 3)), np.zeros(3), np.zeros(2))
    known = Performer(held=(face,))
    app = studio(shelf, Rules(frozenset(("testserver",))), tmp_path, known)
    with TestClient(app) as client, client.websocket_connect("/live") as socket:
        assert len(told(socket, "StageSet")["faces"]) == 1
