"""Every picture of the README and the documents, drawn anew from the package.

    python docs/make_pictures.py

docs/pictures/cast.jpg      the four characters
docs/pictures/driven.jpg    moments of the sample take beside the characters that follow it
docs/pictures/overlay.jpg   what two captures saw in it
docs/pictures/face.png      the toy, small: the sign of the site
docs/pictures/NAME.jpg      a contact sheet of each character and of the generic face
docs/pictures/turntable.webp  the four, turning once while they smile
"""

from contextlib import AbstractContextManager
from importlib import resources
from pathlib import Path

import numpy as np
from PIL import Image

import mien
from mien.capture import CAPTURES, CaptureSettings
from mien.face.animate import Poser
from mien.face.library import GENERIC
from mien.formats.pictures.sources import open_source
from mien.performance.trace import Trace
from mien.view.camera import Camera
from mien.view.contact_sheet import contact_sheet
from mien.view.overlay import overlay
from mien.view.preview import preview
from mien.view.renderer import Renderer

FOLDER = Path(__file__).parent / "pictures"
POSES = {
    "man": (-0.38, {"smile": 0.7, "brows_up": 0.2}),
    "woman": (0.32, {"smile": 0.35}),
    "monkey": (-0.3, {"smile": 0.8, "brows_up": 0.4}),
    "toy": (0.28, {"surprise": 0.75}),
}
QUALITY = 76
TURNS, TURN_SECONDS = 32, 5.0
MOMENTS = (0.95, 2.65, 3.5, 6.9)
"""Seconds of the sample take."""
SEEN = 0.95


def cast() -> np.ndarray:
    """The four in a row, each with a face of its own."""
    row = []
    for name, (yaw, weights) in POSES.items():
        character = mien.load_character(name)
        level = np.array([weights.get(key, 0.0) for key in character.keys.names])
        vertices = Poser(character.face, character.keys).morph(level)
        camera = Camera(yaw=yaw, pitch=0.035, height=290.0, size=(400, 460))
        row.append(Renderer(character.face).render(vertices, camera))
    return np.hstack(row)


def turntable() -> list[Image.Image]:
    """One turn of the four in a row, with a smile that comes and goes."""
    characters = [mien.load_character(name) for name in POSES]
    stage = [
        (character, Poser(character.face, character.keys), Renderer(character.face))
        for character in characters
    ]
    frames = []
    for turn in np.arange(TURNS) / TURNS:
        row = []
        for character, poser, renderer in stage:
            smile = 0.5 - 0.5 * np.cos(2.0 * np.pi * turn)
            vertices = poser.morph(smile * (np.array(character.keys.names) == "smile"))
            camera = Camera(yaw=2.0 * np.pi * turn, pitch=0.05, height=300.0, size=(270, 300))
            row.append(renderer.render(vertices, camera))
        frames.append(Image.fromarray(np.hstack(row)))
    return frames


def overlays() -> np.ndarray:
    """What landmarks and curves saw at a moment of the sample take."""
    shots = []
    with sample() as take:
        frames = list(open_source(take, end=SEEN + 0.5))
    seen = int(np.argmin([abs(frame.time - SEEN) for frame in frames]))
    for method in ("landmarks", "snakes"):
        traces: list[Trace] = []
        CAPTURES[method](frames, CaptureSettings(watch=traces.append), "sample")
        shots.append(overlay(frames[seen].image, traces[seen]))
    return np.hstack(shots)


def sign() -> Image.Image:
    """The toy's face, from the front."""
    toy = mien.load_character("toy")
    level = np.array([{"smile": 0.8}.get(key, 0.0) for key in toy.keys.names])
    camera = Camera(height=230.0, size=(192, 192))
    return Image.fromarray(
        Renderer(toy.face).render(Poser(toy.face, toy.keys).morph(level), camera)
    ).resize((96, 96))


def sample() -> AbstractContextManager[Path]:
    """The sample take as a file."""
    return resources.as_file(resources.files("mien").joinpath("data", "sample.mp4"))


def driven() -> np.ndarray:
    """Moments of the sample take, one above the other in two columns."""
    with sample() as take:
        performance = mien.capture(take)
        characters = [mien.load_character(name) for name in mien.CHARACTERS]
        acts = [(character, mien.animate(performance, character)) for character in characters]
        wanted = [int(np.argmin(abs(performance.time - moment))) for moment in MOMENTS]
        frames = enumerate(preview(acts, open_source(take)))
        shots = [frame.image for i, frame in frames if i in wanted]
    half = len(shots) // 2
    sheet = Image.fromarray(np.vstack([np.hstack(shots[:half]), np.hstack(shots[half:])]))
    return np.asarray(sheet.resize((1600, round(1600 * sheet.height / sheet.width))))


def main() -> None:
    """Draw them all."""
    pictures = {"cast": cast(), "driven": driven(), "overlay": overlays()}
    for name in (*mien.CHARACTERS, GENERIC):
        pictures[name] = contact_sheet(mien.load_character(name))
    FOLDER.mkdir(exist_ok=True)
    for name, picture in pictures.items():
        path = FOLDER / f"{name}.jpg"
        Image.fromarray(picture).save(path, quality=QUALITY, optimize=True)
        print(path.relative_to(Path(__file__).parent), picture.shape)
    sign().save(FOLDER / "face.png", optimize=True)
    first, *others = turntable()
    first.save(
        FOLDER / "turntable.webp",
        save_all=True,
        append_images=others,
        duration=round(1000 * TURN_SECONDS / TURNS),
        loop=0,
        quality=45,
    )


if __name__ == "__main__":
    main()
