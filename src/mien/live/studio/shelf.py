"""The studio's folder: uploaded videos, and takes that were recorded."""

from __future__ import annotations

import re
from collections.abc import AsyncIterator
from datetime import datetime
from pathlib import Path

from mien.errors import InputError, OutputError
from mien.formats.atomic import whole_file
from mien.formats.takes.recording import read_recording
from mien.performance.performance import Performance

LARGEST_UPLOAD = 2 * 2**30
_NAME = re.compile(r"[\w][\w .()+-]{0,99}", re.ASCII)
VIDEOS = frozenset((".mp4", ".mov", ".m4v", ".webm", ".mkv", ".avi"))
TAKE = ".take"


class Shelf:
    """Names in, paths out; a name never leads out of the folder."""

    def __init__(self, folder: Path) -> None:
        """Raises OutputError where the folder cannot be made."""
        self.folder = folder
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise OutputError(f"{folder}: cannot be made ({error.strerror})") from error

    def videos(self) -> list[str]:
        """Names of the uploaded videos."""
        return self._names(VIDEOS)

    def takes(self) -> list[str]:
        """Names of the recordings, the newest last."""
        return self._names(frozenset((TAKE,)))

    def video(self, name: str) -> Path:
        """Where an uploaded video is. Raises InputError."""
        return self._there(name, VIDEOS)

    def take(self, name: str) -> Performance:
        """A recorded take. Raises InputError, FormatError."""
        return read_recording(self._there(name, frozenset((TAKE,))))

    def new_take(self) -> Path:
        """Where the next recording goes."""
        stem = datetime.now().strftime("take %Y-%m-%d %H.%M.%S")
        path, number = self.folder / f"{stem}{TAKE}", 2
        while path.exists():
            path, number = self.folder / f"{stem} ({number}){TAKE}", number + 1
        return path

    async def keep(self, name: str, chunks: AsyncIterator[bytes]) -> Path:
        """Keep an uploaded video, whole or not at all. Raises InputError, OutputError."""
        path = self._place(name, VIDEOS)
        size = 0
        with whole_file(path) as temporary, temporary.open("wb") as file:
            async for chunk in chunks:
                size += len(chunk)
                if size > LARGEST_UPLOAD:
                    raise InputError(f"{name}: larger than {LARGEST_UPLOAD >> 30} GB")
                file.write(chunk)
        return path

    def _names(self, endings: frozenset[str]) -> list[str]:
        return sorted(path.name for path in self.folder.iterdir() if path.suffix in endings)

    def _place(self, name: str, endings: frozenset[str]) -> Path:
        path = self.folder / name
        if not _NAME.fullmatch(name) or path.suffix.lower() not in endings:
            raise InputError(
                f"{name[:60]}: cannot be used as a name here; "
                f"letters and digits, and one of {', '.join(sorted(endings))}"
            )
        return path

    def _there(self, name: str, endings: frozenset[str]) -> Path:
        path = self._place(name, endings)
        if not path.is_file():
            raise InputError(f"{name}: no such file here")
        return path
