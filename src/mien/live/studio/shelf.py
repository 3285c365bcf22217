"""The studio's folder: what was uploaded, and what was recorded and learnt."""

from __future__ import annotations

import re
from collections.abc import AsyncIterator
from datetime import datetime
from pathlib import Path

from mien.errors import InputError, MienError, OutputError
from mien.formats.atomic import whole_file
from mien.formats.markers.file import holds_markers
from mien.performance.performance import Performance
from mien.recipe import capture_markers, load_performance, save_performance

LARGEST_VIDEO = 2 * 2**30
LARGEST_FILE = 256 * 2**20
"""Of anything else: characters of more than half of it are read by no importer."""
_NAME = re.compile(r"[\w][\w .()+-]{0,99}", re.ASCII)

Kind = frozenset[str]
"""Endings of files that may stand for each other."""
VIDEOS = frozenset((".mp4", ".mov", ".m4v", ".webm", ".mkv", ".avi"))
TAKES = frozenset((".take", ".mien"))
BROUGHT = TAKES | {".csv", ".fap", ".c3d", ".trc"}
"""Takes as somebody else's tools write them."""
SOUNDS = frozenset((".wav",))
PERFORMERS = frozenset((".performer",))
MODELS = frozenset((".glb", ".gltf", ".vrm", ".obj", ".zip"))
"""Characters as somebody made them."""
CHARACTERS = frozenset((".character",))
POINTS = frozenset((".toml",))


class Shelf:
    """Names in, paths out; a name never leads out of the folder."""

    def __init__(self, folder: Path) -> None:
        """Raises OutputError where the folder cannot be made."""
        self.folder = folder
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"{folder}: cannot be made ({error.strerror})") from error

    def names(self, kind: Kind) -> list[str]:
        """What there is of a kind, in alphabetical order; takes the newest last."""
        return sorted(path.name for path in self.folder.iterdir() if path.suffix in kind)

    def there(self, name: str, kind: Kind) -> Path:
        """Where a file is. Raises InputError."""
        path = self.place(name, kind)
        if not path.is_file():
            raise InputError(f"{name}: no such file here")
        return path

    def place(self, name: str, kind: Kind) -> Path:
        """Where a file of that name goes. Raises InputError."""
        path = self.folder / name
        if not _NAME.fullmatch(name) or path.suffix.lower() not in kind:
            raise InputError(
                f"{name[:60]}: cannot be used as a name here; "
                f"letters and digits, and one of {', '.join(sorted(kind))}"
            )
        return path

    async def keep(self, name: str, kind: Kind, chunks: AsyncIterator[bytes]) -> Path:
        """Keep what is uploaded, whole or not at all. Raises InputError, OutputError."""
        path = self.place(name, kind)
        size, most = 0, LARGEST_VIDEO if path.suffix.lower() in VIDEOS else LARGEST_FILE
        with whole_file(path) as temporary, temporary.open("wb") as file:
            async for chunk in chunks:
                size += len(chunk)
                if size > most:
                    raise InputError(f"{name}: larger than {most >> 20} MB")
                file.write(chunk)
        return path

    def take(self, name: str) -> Performance:
        """A take. Raises InputError, FormatError."""
        return load_performance(self.there(name, TAKES))

    def admit(self, name: str) -> str:
        """What a take that was brought is called from now on; one that cannot be read goes.
        Raises InputError, FormatError."""
        path = self.there(name, BROUGHT)
        try:
            take = capture_markers(path)[0] if holds_markers(path) else load_performance(path)
        except MienError as error:
            path.unlink()
            raise type(error)(str(error).replace(str(path), name)) from error
        if path.suffix.lower() in TAKES:
            return path.name
        kept = path.with_suffix(".mien")
        save_performance(take, kept)
        path.unlink()
        return kept.name

    def new_take(self) -> Path:
        """Where the next recording goes."""
        stem = datetime.now().strftime("take %Y-%m-%d %H.%M.%S")
        path, number = self.folder / f"{stem}.take", 2
        while path.exists():
            path, number = self.folder / f"{stem} ({number}).take", number + 1
        return path

    def sound(self, take: str) -> Path:
        """Where the sound of a take is, or would be. Raises InputError."""
        return self.place(take, TAKES).with_suffix(".wav")
