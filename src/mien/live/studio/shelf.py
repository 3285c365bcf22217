"""The studio's folder: what was uploaded, and what was recorded and learnt."""

from __future__ import annotations

import re
from collections.abc import AsyncIterator
from datetime import datetime
from pathlib import Path

from mien.errors import InputError, OutputError
from mien.formats.atomic import whole_file
from mien.formats.takes.recording import read_recording
from mien.performance.performance import Performance

LARGEST_VIDEO = 2 * 2**30
LARGEST_FILE = 256 * 2**20
"""Of anything else: characters of more than half of it are read by no importer."""
_NAME = re.compile(r"[\w][\w .()+-]{0,99}", re.ASCII)

Kind = frozenset[str]
"""Endings of files that may stand for each other."""
VIDEOS = frozenset((".mp4", ".mov", ".m4v", ".webm", ".mkv", ".avi"))
TAKES = frozenset((".take",))
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
        """A recorded take. Raises InputError, FormatError."""
        return read_recording(self.there(name, TAKES))

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
