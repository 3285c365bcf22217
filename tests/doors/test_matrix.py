"""Any performance drives any face: every source by every kind of character by every output.

One act is performed in every way there is, ten frames long: the mouth opens. Whoever acts it must
open theirs, and every file written of it must say so.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import av
import numpy as np
import pytest
from terminal import needs_landmarks

import mien
from clips import write_video
from gltf_reader import Reader
from guests import document, write_guest, write_vrm_guest
from mien.errors import InputError
from mien.face.animate import Poser
from mien.face.character import Character
from mien.face.databank import databank
from mien.face.library import generic_face
from mien.face.store import write_character
from mien.face.targets import targets
from mien.formats.databank_file import write_databank
from mien.formats.save import FOLDERS, SAVERS
from mien.formats.streams import vmc
from mien.formats.takes.livelink import write_livelink
from mien.formats.takes.recording import Recorder
from mien.formats.takes.table import read_table
from mien.live.stage import Stage
from mien.performance.arkit_frame import ArkitFrame
from mien.performance.curves import Curves
from mien.performance.marker_take import MarkerTake
from mien.performance.performance import Performance
from mien.recipe import animate_surface, load_databank
from mien.rig.importer import import_character
from mien.sculpt.transfer.make import make
from mien.sculpt.transfer.shapes import driven, shape_sets, source_of
from mien.view.camera import Camera
from mien.view.renderer import Renderer
from mien.vocabulary.arkit import names
from takes import WORN, c3d

OPEN = np.array([0.0, 0.0, 0.0, 0.0, 0.4, 0.8, 1.0, 1.0, 1.0, 1.0])
"""How far the mouth is open in each frame."""
TIME = np.arange(len(OPEN)) / 30.0
REST = (0.0, 0.1)
LEAST = 5.0
"""mm between the lips of whoever acts it, at the end."""

Act = tuple[Character, Curves]


@cache
def _film(folder: Path) -> Path:
    woman = mien.load_character("woman")
    poser, renderer = Poser(woman.face, woman.keys), Renderer(woman.face)
    wide = np.array(woman.keys.names) == "jaw_open"
    camera = Camera(size=(320, 320))
    pictures = [renderer.render(poser.pose(level * wide), camera) for level in OPEN]
    return write_video(folder / "woman.mp4", pictures)


def _seen(method: str) -> Callable[[Path], Performance]:
    return lambda folder: mien.capture(_film(folder), method=method, neutral=REST)


def _markers(folder: Path) -> Performance:
    generic = generic_face()
    rows = generic.face.points.index(list(WORN.values()))
    still = generic.face.points.at(generic.face.vertices)[rows]
    field = generic.face.points.at(generic.keys["jawOpen"])[rows]
    take = MarkerTake(tuple(WORN), TIME, still + OPEN[:, None, None] * field, source="act")
    return mien.capture(c3d(take, folder / "act.c3d"), neutral=REST)


def _shapes() -> np.ndarray:
    return OPEN[:, None] * (np.array(names()) == "jawOpen")


def _livelink(folder: Path) -> Performance:
    path, frames = folder / "act.csv", len(OPEN)
    straight, ahead = np.tile(np.eye(3), (frames, 1, 1)), np.zeros((frames, 2, 2))
    write_livelink(path, TIME, _shapes(), straight, ahead)
    return mien.load_performance(path)


def _stream(folder: Path) -> Performance:
    """What a VMC sender says, heard by the stage and recorded as it comes."""
    stage, decoder, path = Stage(), vmc.Decoder(), folder / "act.take"
    recorder = None
    for time, shapes in zip(TIME.tolist(), _shapes(), strict=True):
        for datagram in vmc.encode(ArkitFrame(time, shapes)):
            for frame in decoder.decode(datagram, time):
                heard = stage.hear(frame).performance
                assert heard is not None
                recorder = recorder or Recorder(path, heard)
                recorder.write(heard)
    assert recorder is not None
    recorder.close()
    return mien.load_performance(path)


def _fap(folder: Path) -> Performance:
    mien.save_performance(_livelink(folder), folder / "act.fap")
    return mien.load_performance(folder / "act.fap")


def _guest(folder: Path, called: list[str] | None = None) -> Character:
    path, points = write_guest(folder, called=called)
    return import_character(path, points=points).character


def _vrm(folder: Path) -> Character:
    path, points = write_vrm_guest(folder)
    return import_character(path, points=points).character


def _made(folder: Path) -> Character:
    chosen = shape_sets()["mien"]
    made = make(mien.load_character("man").face, source_of(chosen), chosen.names, "made")
    write_character(folder / "made.npz", driven(made.character, "mien"))
    return mien.load_character(folder / "made.npz")


def _acts(build: Callable[[Path], Character]) -> Callable[[Performance, Path], Act]:
    character = cache(build)
    return lambda performance, folder: (
        character(folder),
        mien.animate(performance, character(folder)),
    )


@cache
def _bank(folder: Path) -> Path:
    write_databank(folder / "bank.npz", databank(mien.load_character("woman")))
    return folder / "bank.npz"


def _surface(performance: Performance, folder: Path) -> Act:
    return animate_surface(performance, load_databank(_bank(folder)))


SOURCES: Mapping[str, Callable[[Path], Performance]] = {
    "landmarks": _seen("landmarks"),
    "snakes": _seen("snakes"),
    "tracker": _seen("tracker"),
    "c3d": _markers,
    "livelink": _livelink,
    "vmc": _stream,
    "fap": _fap,
}
KINDS: Mapping[str, Callable[[Performance, Path], Act]] = {
    "built-in": _acts(lambda folder: mien.load_character("monkey")),
    "named": _acts(lambda folder: _guest(folder / "named")),
    "nameless": _acts(lambda folder: _guest(folder / "nameless", [f"x{k}" for k in range(9)])),
    "vrm": _acts(lambda folder: _vrm(folder / "vrm")),
    "made": _acts(_made),
    "databank": _acts(lambda folder: mien.load_character(_bank(folder))),
    "surface": _surface,
}
ONE_CAMERA = ("landmarks", "snakes", "tracker")
"""Sources without depth: a databank's surface needs it, its faces as a character do not."""


@pytest.fixture(scope="module")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("matrix")


@pytest.fixture(scope="module")
def perform(shared: Path) -> Callable[[str], Performance]:
    """A source's performance, captured once."""
    return cache(lambda source: SOURCES[source](shared))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(
    "source",
    [
        pytest.param(name, marks=needs_landmarks if name in ("landmarks", "tracker") else ())
        for name in SOURCES
    ],
)
def test_any_performance_drives_any_face(
    source: str, kind: str, perform: Callable[[str], Performance], shared: Path, tmp_path: Path
) -> None:
    performance = perform(source)
    if kind == "surface" and source in ONE_CAMERA:
        with pytest.raises(InputError, match="-c BANK"):
            _surface(performance, shared)
        return
    character, curves = KINDS[kind](performance, shared)
    assert len(curves) == len(OPEN)
    lips = gaps(character, curves)
    assert lips[-3:].min() - lips[:3].max() > LEAST
    for ending in SAVERS:
        if ending == ".vrma" and kind != "vrm":
            with pytest.raises(InputError, match="only VRM"):
                mien.save(curves, tmp_path / "act.vrma", character)
            continue
        written = mien.save(curves, tmp_path / f"act{ending}", character)
        assert written.is_dir() == (ending in FOLDERS)
        CHECKS[ending](written, character, curves)
    mien.film([(character, curves)], tmp_path / "act.mp4")
    with av.open(str(tmp_path / "act.mp4")) as film:
        assert sum(1 for _ in film.decode(video=0)) == len(OPEN)


def gaps(character: Character, curves: Curves) -> np.ndarray:
    """(F,) mm between the lips."""
    poser, points = Poser(character.face, targets(character, curves.names)), character.face.points
    upper, lower = points.index(["2.2", "2.3"])
    places = [points.at(poser.morph(weights)) for weights in curves.weights]
    return np.array([np.linalg.norm(place[upper] - place[lower]) for place in places])


def _check_glb(path: Path, character: Character, curves: Curves) -> None:
    found = [
        (times, values.reshape(len(times), -1))
        for (_, what), (times, values) in Reader(path).channels().items()
        if what == "weights"
    ]
    assert found
    for times, values in found:
        assert np.allclose(times, curves.time, atol=1e-6)
        for column in values.T:
            assert any(np.allclose(column, own, atol=1e-6) for own in curves.weights.T)


def _check_table(path: Path, character: Character, curves: Curves) -> None:
    table = read_table(path)
    assert table.names == curves.names
    assert np.allclose(table.weights, curves.weights, atol=1e-9)


def _check_meshes(path: Path, character: Character, curves: Curves) -> None:
    meshes = sorted(path.glob("*.obj"))
    assert len(meshes) == len(OPEN)
    still, last = (
        np.array([line.split()[1:4] for line in mesh.open() if line.startswith("v ")], float)
        for mesh in (meshes[0], meshes[-1])
    )
    assert 1e3 * np.abs(last - still).max() > LEAST


def _check_vrma(path: Path, character: Character, curves: Curves) -> None:
    told = document(path)["extensions"]["VRMC_vrm_animation"]["expressions"]["custom"]
    assert "jawOpen" in told


CHECKS: Mapping[str, Callable[[Path, Character, Curves], None]] = {
    ".glb": _check_glb,
    ".csv": _check_table,
    ".obj": _check_meshes,
    ".vrma": _check_vrma,
}
