"""``mien capture --overlay``: the take with what was seen drawn over it."""

from __future__ import annotations

import time
from pathlib import Path

import av
import numpy as np
import pytest
from terminal import FRAMES, mien, needs_landmarks

from clips import noise, write_video
from mien.face.library import load_character
from mien.formats.pictures.sources import open_source
from mien.overlay_film import overlay_film
from mien.performance.frame import Frame
from mien.performance.trace import Trace
from mien.recipe import load_performance
from mien.view.camera import Camera
from mien.view.overlay import overlay
from mien.view.renderer import Renderer


def test_curves_are_drawn_where_they_are() -> None:
    image = np.zeros((480, 640, 3), np.uint8)
    beside = np.full((240, 120, 3), 60, np.uint8)
    line = np.array([[100.5, 200.5], [300.5, 200.5]])
    drawn = overlay(image, Trace(curves={"lips_upper": line}, beside=beside, notes=("lost",)))
    assert drawn.shape == (480, 640 + 240, 3)
    assert drawn[200, 200].max() > 150
    assert drawn[210, 200].max() == 0
    assert (drawn[300, 700] == 60).all()
    assert image.max() == 0


def test_small_pictures_are_enlarged_and_wild_places_do_no_harm() -> None:
    wild = np.array([[-1e9, 5.0], [1e9, np.float64(40.0)]])
    drawn = overlay(np.zeros((48, 64, 3), np.uint8), Trace(curves={"silhouette": wild}))
    assert drawn.shape == (480, 640, 3)


@pytest.mark.parametrize("capture", ["snakes", "landmarks"])
def test_a_take_and_its_overlay_are_as_long(take: Path, tmp_path: Path, capture: str) -> None:
    done = mien(
        "capture",
        take,
        "--capture",
        capture,
        "-o",
        "a.mien",
        "--overlay",
        "seen.mp4",
        cwd=tmp_path,
    )
    if capture == "landmarks" and "extra" in done.stderr:
        pytest.skip("the landmark networks are not installed")
    assert done.returncode == 0, done.stderr
    assert str(Path("seen.mp4")) in done.stdout
    with av.open(str(tmp_path / "seen.mp4")) as film:
        assert sum(1 for _ in film.decode(video=0)) == FRAMES


@needs_landmarks
def test_of_two_faces_one_is_followed_and_it_is_said(take: Path, tmp_path: Path) -> None:
    man = load_character("man").face
    beside = Renderer(man).render(man.vertices, Camera(size=(256, 256)))
    pair = [np.hstack([frame.image, beside]) for frame in open_source(take)]
    write_video(tmp_path / "pair.mp4", pair)
    done = mien("capture", "pair.mp4", "--capture", "tracker", "-o", "a.mien", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "; one of 2 faces was followed" in done.stdout
    performance = load_performance(tmp_path / "a.mien")
    assert performance.faces == 2
    assert np.ptp(performance.translation[:, 0]) < 20.0, "it jumped from one to the other"


def test_no_overlay_is_left_where_there_is_no_face(tmp_path: Path) -> None:
    film = write_video(tmp_path / "noise.mp4", noise(4))
    done = mien(
        "capture", film, "--capture", "snakes", "-o", "a.mien", "--overlay", "b.mp4", cwd=tmp_path
    )
    assert done.returncode == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["noise.mp4"]


def test_no_overlay_is_left_where_a_capture_fails_after_its_last_frame(tmp_path: Path) -> None:
    path = tmp_path / "b.mp4"
    frames = [Frame(image, 0.04 * n) for n, image in enumerate(noise(4))]

    def fail_at_the_end() -> None:
        with overlay_film(path, frames) as watch:
            for _ in frames:
                watch(Trace())
            deadline = time.monotonic() + 0.5
            while not path.exists() and time.monotonic() < deadline:
                time.sleep(0.01)
            raise RuntimeError

    with pytest.raises(RuntimeError):
        fail_at_the_end()
    assert list(tmp_path.iterdir()) == []


def test_overlays_of_what_is_captured_already_are_refused(captured: Path, tmp_path: Path) -> None:
    done = mien("capture", captured, "-o", "a.mien", "--overlay", "b.mp4", cwd=tmp_path)
    assert done.returncode == 1
    assert "--overlay" in done.stderr
