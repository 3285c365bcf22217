"""Where pictures come from: a video file, a folder of images, a camera."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Protocol

from mien.errors import InputError
from mien.formats.pictures.camera import open_camera
from mien.formats.pictures.images import open_images
from mien.formats.pictures.video import open_video
from mien.performance.frame import Frame


class Source(Protocol):
    """A recording that can be looked at, frame by frame, once or again."""

    @property
    def name(self) -> str:
        """What the user called it, for messages."""

    @property
    def size(self) -> tuple[int, int]:
        """(width, height) of every picture, upright and with square pixels."""

    @property
    def rate(self) -> float:
        """Frames a second, on average."""

    @property
    def count(self) -> int | None:
        """Frames to expect, None where nobody can tell; for progress, not for trust."""

    def __iter__(self) -> Iterator[Frame]:
        """Frames in order; time is 0 at the first. Raises MienError when the source breaks."""


@dataclass(frozen=True, slots=True)
class Cut:
    """Which part of a recording is wanted, and how."""

    start: float
    """Seconds from its first picture."""
    end: float
    """Seconds from its first picture, or infinity."""
    mirror: bool
    """Undo the flip of a selfie take."""
    rate: float | None
    """Frames a second where the recording cannot tell: a folder of images."""


def _camera(name: str, cut: Cut) -> Source:
    number = name.removeprefix("camera:")
    if not number.isdecimal():
        raise InputError(f"{name}: a camera is named by its number, such as camera:0")
    if cut.end == inf or cut.start:
        raise InputError(f"{name}: say how many seconds to record with --end (and no --start)")
    return open_camera(int(number), cut.end, cut.mirror)


def _folder(name: str, cut: Cut) -> Source:
    return open_images(Path(name), cut.start, cut.end, cut.mirror, cut.rate or 30.0)


def _video(name: str, cut: Cut) -> Source:
    return open_video(Path(name), cut.start, cut.end, cut.mirror)


SOURCES: dict[str, Callable[[str, Cut], Source]] = {
    "camera": _camera,
    "folder": _folder,
    "video": _video,
}


def open_source(
    path: str | Path,
    start: float | None = None,
    end: float | None = None,
    mirror: bool = False,
    rate: float | None = None,
) -> Source:
    """Open a video file, a folder of images or "camera:0".

    ``start`` and ``end`` are seconds; ``mirror`` flips the pictures of a selfie take; ``rate`` is
    for folders of images, which do not tell theirs (30). Raises InputError, FormatError.
    """
    cut = Cut(start or 0.0, inf if end is None else end, mirror, rate)
    if not (0.0 <= cut.start < cut.end):
        raise InputError(
            f"--start {cut.start:g} --end {cut.end:g}: need 0 <= start < end, in seconds"
        )
    name = kind(path)
    if rate is not None and (name != "folder" or not 0.0 < rate <= 1000.0):
        raise InputError(
            f"--rate {rate:g}: frames a second of a folder of images, above 0 and up to 1000"
        )
    return SOURCES[name](str(path), cut)


def kind(path: str | Path) -> str:
    """Key into SOURCES. Raises InputError where nothing of that name exists."""
    if str(path).startswith("camera:"):
        return "camera"
    if Path(path).is_dir():
        return "folder"
    if Path(path).is_file():
        return "video"
    raise InputError(f"{path}: no such file")
