"""Which takes are meant, and what each is called."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from mien.errors import InputError
from mien.formats.markers.file import READERS as MARKERS
from mien.formats.pictures.images import ENDINGS as PICTURES
from mien.recipe import READERS

VIDEOS = frozenset(
    {".mp4", ".mov", ".m4v", ".mkv", ".webm", ".avi", ".mpg", ".mpeg", ".mts", ".wmv", ".flv"}
)
"""What is taken for a video when a folder is searched; a file that is named is always tried."""


@dataclass(frozen=True, slots=True)
class Take:
    """A recording, by name."""

    path: str
    """Absolute: workers have folders of their own."""
    stem: str
    shared: bool
    """Another take of the batch has the same stem."""

    def name(self, digest: str) -> str:
        """What its results are called. A file that moves keeps the name of its results."""
        return f"{self.stem}-{digest[:8]}" if self.shared else self.stem


def find_takes(paths: Iterable[str | Path]) -> list[Take]:
    """The takes at ``paths``: files, folders of images, and folders of both at any depth.

    Raises InputError where nothing is there.
    """
    found: dict[Path, None] = {}
    for path in map(Path, paths):
        if not path.exists():
            raise InputError(f"{path}: no such file or folder")
        inside = list(_inside(path.resolve())) if path.is_dir() else [path.resolve()]
        if not inside:
            raise InputError(f"{path}: holds no takes")
        found |= dict.fromkeys(inside)
    stems = Counter(path.stem.lower() for path in found)
    return [Take(str(path), path.stem, stems[path.stem.lower()] > 1) for path in found]


def _inside(folder: Path) -> Iterator[Path]:
    entries = sorted(entry for entry in folder.iterdir() if not entry.name.startswith("."))
    takes = [entry for entry in entries if entry.suffix.lower() in {*VIDEOS, *MARKERS, *READERS}]
    # A picture beside takes is somebody's poster of one; pictures alone are frames.
    if not takes and any(entry.suffix.lower() in PICTURES for entry in entries):
        yield folder
    yield from takes
    for entry in entries:
        if entry.is_dir():
            yield from _inside(entry)
