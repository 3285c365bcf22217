"""Takes that go in and out of the studio as others' tools know them."""

from __future__ import annotations

import json
import re
import struct
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the extra 'studio' is not installed")

from starlette.testclient import TestClient

from mien.formats.performer_file import write_performer
from mien.formats.takes.mien_file import write_performance
from mien.live.studio import shelf as shelves
from mien.live.studio.packet import posed, unpack
from mien.live.studio.shelf import Shelf
from mien.performance.arkit_frame import ArkitFrame, performance_of
from mien.performance.performance import Performance
from mien.performance.performer import HeldFace, Performer
from mien.recipe import moving
from mien.vocabulary.arkit import names

ENDINGS = Path(__file__).parents[2] / "studio/src/endings.ts"


def opening(frames: int = 12) -> Performance:
    shapes = np.zeros((frames, 52))
    shapes[:, names().index("jawOpen")] = np.linspace(0.0, 0.8, frames)
    return performance_of([ArkitFrame(i / 30, row) for i, row in enumerate(shapes)], "a test")


@pytest.mark.parametrize("kind", ["mien", "csv", "fap"])
def test_a_take_comes_back_as_it_went(client: TestClient, shelf: Shelf, kind: str) -> None:
    write_performance(opening(), shelf.place("first.mien", shelves.TAKES))
    told = client.get(f"/takes/first.mien/performance.{kind}")
    assert told.headers["content-disposition"].endswith(f'"first.{kind}"')
    assert client.put(f"/takes/again.{kind}", content=told.content).json() == {"name": "again.mien"}
    assert shelf.names(shelves.BROUGHT) == ["again.mien", "first.mien"]
    again = moving(shelf.take("again.mien"))
    assert len(again) == 12
    assert np.ptp(again.motion[:, again.points.index("2.1"), 1]) > 5.0


def test_a_take_without_pictures_shows_its_points() -> None:
    tag, body = posed(moving(opening())[-1:])
    places = np.frombuffer(body, "<f4").reshape(-1, 2)
    assert tag == "PNTS"
    assert ((places > 0.0) & (places < 1.0)).all()


@pytest.mark.parametrize("name", ["no.csv", "no.fap", "no.c3d", "no.mien", "no.take"])
def test_what_is_no_take_is_refused_in_a_line_and_goes(
    client: TestClient, shelf: Shelf, name: str
) -> None:
    answer = client.put(f"/takes/{name}", content=b"\0nothing of that kind")
    assert answer.status_code == 400
    assert answer.json()["error"].startswith(name)
    assert str(shelf.folder) not in answer.json()["error"]
    assert shelf.names(shelves.BROUGHT) == []


def test_no_take_leads_out_of_the_folder(client: TestClient, shelf: Shelf) -> None:
    for address in ("/takes/..%2Fx.mien/performance.csv", "/takes/x.mien/performance.csv"):
        assert client.get(address).status_code in (400, 404)
    write_performance(opening(), shelf.place("x.mien", shelves.TAKES))
    assert client.get("/takes/x.mien/performance.exe").status_code == 404


def test_a_take_from_elsewhere_is_played_whatever_faces_were_held(
    client: TestClient, shelf: Shelf
) -> None:
    write_performance(opening(), shelf.place("x.mien", shelves.TAKES))
    motion, away = np.ones((5, 3)), np.zeros(3)
    smile = HeldFace("landmarks", "", {"smile": 1.0}, motion, away, np.zeros(2))
    write_performer(Performer(held=(smile,)), shelf.place("me.performer", shelves.PERFORMERS))
    with client.websocket_connect("/live") as socket:
        socket.send_text(json.dumps({"kind": "Meet", "name": "me.performer"}))
        socket.send_text(json.dumps({"kind": "Look", "source": "take", "name": "x.mien"}))
        for _ in range(200):
            message = socket.receive()
            sections = dict(unpack(message["bytes"])) if message.get("bytes") else {}
            if "C000" in sections:
                break
    assert struct.unpack("<dd", sections["PLAY"])[1] == pytest.approx(11 / 30)
    assert "PNTS" in sections


def test_the_page_knows_the_endings_of_the_server() -> None:
    told = dict(re.findall(r"const (\w+) = \[(.*)\]", ENDINGS.read_text()))
    for name, kind in (("TAKES", "BROUGHT"), ("VIDEOS",) * 2, ("PERFORMERS",) * 2, ("MODELS",) * 2):
        assert set(json.loads(f"[{told[name]}]")) == getattr(shelves, kind)
