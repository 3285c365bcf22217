"""Archives of files that somebody sends: unpacked under bounds, and never outside their folder."""

from __future__ import annotations

import zipfile
from pathlib import Path, PurePosixPath

from mien.errors import FormatError
from mien.formats.archive import DAMAGE, first_line

MAX_FILES = 4000
MAX_BYTES = 1 << 30
"""Of all files together, as they come out."""
_CHUNK = 1 << 20


def unpack(path: Path, folder: Path) -> None:
    """Unpack the ZIP ``path`` into ``folder``. Raises FormatError for anything but a whole, sane
    one."""
    try:
        with zipfile.ZipFile(path) as archive:
            entries = [entry for entry in archive.infolist() if not entry.is_dir()]
            if len(entries) > MAX_FILES:
                raise ValueError(f"more than {MAX_FILES} files in it")
            left = MAX_BYTES
            for entry in entries:
                left = _extract(archive, entry, folder / _inside(entry.filename), left)
    except DAMAGE as error:
        raise FormatError(f"{path.name}: not a sound ZIP ({first_line(error)})") from error


def _inside(name: str) -> PurePosixPath:
    """``name`` as a path that stays in its folder. Raises ValueError."""
    place = PurePosixPath(name)
    if place.is_absolute() or ".." in place.parts or "\\" in name or ":" in name or "\0" in name:
        raise ValueError(f"a file in it would lie elsewhere: {name[:60]!r}")
    return place


def _extract(archive: zipfile.ZipFile, entry: zipfile.ZipInfo, to: Path, left: int) -> int:
    """Write one file; bytes that are left for the others. Raises ValueError."""
    to.parent.mkdir(parents=True, exist_ok=True)
    with archive.open(entry) as stream, to.open("wb") as file:
        while chunk := stream.read(_CHUNK):
            left -= len(chunk)
            if left < 0:
                raise ValueError(f"more than {MAX_BYTES >> 30} GB unpacked")
            file.write(chunk)
    return left
