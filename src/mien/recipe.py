"""The recipe: from a recording to curves. Knows every verb, owns no mathematics."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TypeVar

from mien.capture import CAPTURES, CaptureSettings
from mien.errors import InputError
from mien.face.character import Character
from mien.face.library import load_character
from mien.formats.sources import open_source
from mien.mapping import MAPPERS, Settings
from mien.performance.curves import Curves
from mien.performance.filters import smooth as smooth_curves
from mien.performance.performance import Performance

Progress = Callable[[int, int | None], None]
Way = TypeVar("Way")


def capture(
    path: str | Path,
    *,
    method: str = "landmarks",
    start: float | None = None,
    end: float | None = None,
    mirror: bool = False,
    neutral: tuple[float, float] | None = None,
    focal: float | None = None,
    progress: Progress | None = None,
) -> Performance:
    """What the performer in a recording did.

    ``path`` names a video, a folder of images or "camera:0"; ``start`` and ``end`` cut it, in
    seconds; ``mirror`` undoes a selfie's flip; ``neutral`` (first, last) names the seconds in
    which the face rests (found otherwise); ``focal`` is the camera's focal length in pixels.
    ``progress`` is called with frames done and frames expected (None: unknown).
    Raises InputError, FormatError, NoFaceError, MissingExtraError.
    """
    way = _choose(CAPTURES, method, "capture")
    source = open_source(path, start, end, mirror)
    count = source.count
    told = None if progress is None else (lambda done: progress(done, count))
    return way(source, CaptureSettings(neutral, focal), source.name, told)


def animate(
    performance: Performance,
    character: str | Path | Character,
    *,
    mapping: str = "cardinal",
    gain: float = 1.0,
    smooth: bool = True,
) -> Curves:
    """The curves with which ``character`` acts ``performance``.

    ``gain`` exaggerates (1 leaves as it is); ``smooth`` False leaves the detector's tremble in.
    Raises InputError.
    """
    if not isinstance(character, Character):
        character = load_character(character)
    mapper = _choose(MAPPERS, mapping, "mapping")(character, performance, Settings(gain=gain))
    curves = mapper(performance)
    return smooth_curves(curves) if smooth else curves


def _choose(ways: Mapping[str, Way], name: str, what: str) -> Way:
    if name not in ways:
        raise InputError(f"--{what} {name}: no such {what}; there are {', '.join(ways)}")
    return ways[name]
