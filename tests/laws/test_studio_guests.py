"""Characters that are brought to the studio: admitted, pointed at, acting; or refused in a line."""

from __future__ import annotations

import json
import zipfile
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("starlette", reason="the extra 'studio' is not installed")

from starlette.testclient import TestClient

from guests import DATA, PICKS, edited, guest, needs_characters, write_guest
from mien.formats.takes.recording import Recorder
from mien.live.studio.shelf import Shelf
from mien.performance.arkit_frame import ArkitFrame, performance_of
from mien.rig.picks import read_picks
from mien.vocabulary.arkit import names

FLAT = np.array([1.0, 0.35, 1.0])
"""Nobody's face is found on a head as flat as this."""


@pytest.fixture(scope="module")
def flat(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path, _ = write_guest(tmp_path_factory.mktemp("guest"))
    return edited(path, lambda told: told["nodes"][1].update(scale=FLAT.tolist())).read_bytes()


def points() -> dict[str, list[float]]:
    face = guest().face
    return {fdp: (face.point(fdp) * FLAT / 1e3).tolist() for fdp in PICKS}


def test_a_guest_is_pointed_at_and_acts(client: TestClient, shelf: Shelf, flat: bytes) -> None:
    told = client.put("/characters/flat.glb", content=flat).json()
    assert (told["name"], told["found"]) == ("flat", False)
    assert "face" in told["notes"][0]
    shown = client.get("/models/flat.glb").content
    size = int.from_bytes(shown[12:16], "little")
    box = json.loads(shown[20 : 20 + size])["scenes"][0]["extras"]["face"]
    assert box["low"][1] < points()["9.3"][1] < box["high"][1]
    told = client.put("/models/flat.glb/points", content=json.dumps({"points": points()})).json()
    assert told["found"]
    picks = read_picks(shelf.folder / "flat.toml")
    assert all(np.allclose(picks[fdp], place) for fdp, place in points().items())
    assert client.get("/points/flat.toml").text.count(" = [") == len(PICKS)
    assert client.get("/characters/flat.glb").content[:4] == b"glTF"
    shapes = np.zeros((5, 52))
    shapes[:, names().index("jawOpen")] = np.linspace(0.0, 1.0, 5)
    take = performance_of([ArkitFrame(i / 30, row) for i, row in enumerate(shapes)], "a test")
    recorder = Recorder(shelf.new_take(), take)
    recorder.write(take)
    recorder.close()
    (name,) = (path.name for path in shelf.folder.glob("*.take"))
    table = client.get(f"/takes/{name}/flat.csv").text.splitlines()
    column = table[0].split(",").index("jawOpen")
    assert float(table[-1].split(",")[column]) > 0.5
    assert client.get(f"/takes/{name}/flat.glb").content[:4] == b"glTF"
    assert client.get(f"/takes/{name}/flat.exe").status_code == 404


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"[]",
        b'{"points": 1}',
        b'{"points": {"9.3": [1, 2]}}',
        b'{"points": {"9.3": ["x", 1, 2]}}',
        b'{"points": {"77.3": [1, 2, 3]}}',
        b'{"points": {"9.3": [1, 2, 3]}}',
        b'{"points": {"9.3": [NaN, 2, 3]}}',
        b" " * 70_000,
        b'{"points":' * 20_000,
    ],
)
def test_points_that_are_none_are_refused(
    client: TestClient, shelf: Shelf, flat: bytes, body: bytes
) -> None:
    (shelf.folder / "flat.glb").write_bytes(flat)
    answer = client.put("/models/flat.glb/points", content=body)
    assert answer.status_code == 400
    assert "\n" not in answer.json()["error"]
    assert [path.name for path in shelf.folder.iterdir()] == ["flat.glb"]


def test_what_is_no_character_is_refused(client: TestClient, tmp_path: Path) -> None:
    archive = tmp_path / "a.zip"
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("../../outside.glb", b"glTF")
    nothing = tmp_path / "b.zip"
    with zipfile.ZipFile(nothing, "w") as file:
        file.writestr("readme.txt", b"no face")
    for name, body in (
        ("a.zip", archive.read_bytes()),
        ("b.zip", nothing.read_bytes()),
        ("c.zip", b"no archive"),
        ("d.glb", b"glTF and nothing else"),
        ("e.exe", b"MZ"),
        ("f.gltf", b"[" * 100_000),
    ):
        answer = client.put(f"/characters/{name}", content=body)
        assert answer.status_code == 400, name
        assert "\n" not in answer.json()["error"]
    assert not list(tmp_path.glob("**/outside.glb"))
    assert client.get("/models/none.glb").status_code == 400


@needs_characters
def test_broken_files_of_others_are_refused_in_a_line(client: TestClient) -> None:
    for path in sorted((DATA / "bad").glob("*.gl*")):
        answer = client.put(f"/characters/{path.name}", content=path.read_bytes())
        assert answer.status_code in (200, 400), path.name
        assert "\n" not in answer.json().get("error", "")
