"""What is installed, what works, and what is slow."""

from __future__ import annotations

import argparse
import os
import platform
import sys
import tempfile
from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib import metadata
from pathlib import Path
from time import perf_counter

from mien.cli.command import tell
from mien.errors import MienError

LANDMARKS = """\
To follow faces with landmarks, install MediaPipe 0.10.21, the last that carries its networks:
  with uv (lean)  uv sync --extra landmarks            in a checkout of mien
  with pip        pip install --no-deps mediapipe==0.10.21
                  pip install 'protobuf>=4.25.3,<5' 'opencv-python-headless<5' \\
                              matplotlib absl-py flatbuffers attrs
pip install 'mien[landmarks]' works too, where libGL is present; it takes three times the room."""

PACKAGES = (
    "numpy",
    "scipy",
    "numba",
    "daqp",
    "av",
    "pillow",
    "rich",
    "mediapipe",
    "opencv-python-headless",
    "protobuf",
)
OPTIONAL = {"mediapipe", "opencv-python-headless", "protobuf"}


class DoctorError(MienError):
    """Something that every command needs does not work."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that was looked at."""

    name: str
    works: bool
    detail: str
    seconds: float | None = None


def configure(parser: argparse.ArgumentParser) -> None:
    del parser  # the common options are all it has


def run(options: argparse.Namespace) -> None:
    versions = {name: _version(name) for name in PACKAGES}
    findings = [_look(name, check) for name, check in CHECKS.items()]
    remarks = _slow()
    landmarks = all(f.works for f in findings if f.name == "landmarks")
    tell(
        options,
        {
            "python": platform.python_version(),
            "mien": _version("mien"),
            "packages": versions,
            "checks": [asdict(finding) for finding in findings],
            "slow": remarks,
        },
        f"mien {_version('mien')}, Python {platform.python_version()}, {platform.platform()}, "
        f"{os.cpu_count()} processors",
        "",
        *(f"  {name:24}{version or _absent(name)}" for name, version in versions.items()),
        "",
        *(_line(finding) for finding in findings),
        *(f"  slow      {remark}" for remark in remarks),
        *(() if landmarks else ("", LANDMARKS)),
    )
    broken = [finding.name for finding in findings if not finding.works]
    if set(broken) - {"landmarks"}:
        raise DoctorError(f"{', '.join(broken)}: does not work here; see above, or install again")


def _look(name: str, check: Callable[[], str]) -> Finding:
    begin = perf_counter()
    try:
        detail = check()
    except Exception as error:  # whatever a broken installation throws is the finding
        return Finding(name, False, (str(error) or type(error).__name__).splitlines()[0])
    return Finding(name, True, detail, round(perf_counter() - begin, 3))


def _line(finding: Finding) -> str:
    state = "works" if finding.works else "FAILS"
    took = "" if finding.seconds is None else f" ({finding.seconds:.1f} s)"
    return f"  {state:10}{finding.name}: {finding.detail}{took}"


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def _absent(name: str) -> str:
    return "not installed (optional)" if name in OPTIONAL else "MISSING"


def _video() -> str:
    """Write a short film and read it again."""
    import av
    import numpy as np

    from mien.formats.pictures.video import open_video

    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "film.mp4")
        with av.open(str(path), "w") as film:
            stream = film.add_stream("libx264", rate=30)
            stream.width = stream.height = 64
            stream.pix_fmt = "yuv420p"
            picture = np.zeros((64, 64, 3), np.uint8)
            for _ in range(3):
                film.mux(stream.encode(av.VideoFrame.from_ndarray(picture)))
            film.mux(stream.encode())
        frames = len(list(open_video(path)))
    ffmpeg = ".".join(map(str, av.library_versions["libavcodec"]))
    return f"wrote and read {frames} frames with libavcodec {ffmpeg}"


def _characters() -> str:
    from mien.face.library import CHARACTERS, load_character

    return ", ".join(load_character(name).name for name in CHARACTERS)


def _landmarks() -> str:
    import numpy as np

    from mien.capture.detector import Detector

    picture = np.zeros((480, 640, 3), np.uint8)
    with Detector() as detector:
        detector.landmarks(picture)
        begin = perf_counter()
        for _ in range(10):
            detector.landmarks(picture)
        each = (perf_counter() - begin) / 10
    return f"looks for a face in {1000 * each:.1f} ms a picture"


def _renderer() -> str:
    from mien.face.library import load_character
    from mien.view.camera import Camera
    from mien.view.renderer import Renderer

    face = load_character("man").face
    renderer, camera = Renderer(face), Camera(size=(360, 360))
    begin = perf_counter()
    renderer.render(face.vertices, camera)
    first = perf_counter() - begin
    begin = perf_counter()
    renderer.render(face.vertices, camera)
    return (
        f"{first:.1f} s for the first picture, then {1000 * (perf_counter() - begin):.0f} ms each"
    )


CHECKS: dict[str, Callable[[], str]] = {
    "video": _video,
    "characters": _characters,
    "renderer": _renderer,
    "landmarks": _landmarks,
}


def _slow() -> list[str]:
    found = []
    if sys.dont_write_bytecode:
        found.append("PYTHONDONTWRITEBYTECODE is set: every start compiles mien and numba anew")
    if (os.cpu_count() or 1) < 2:
        found.append("one processor: pictures are not decoded while faces are looked for")
    return found
