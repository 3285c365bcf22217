"""Output that is whole or absent: written beside its destination and renamed at the end."""

from __future__ import annotations

import errno
import os
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mien.errors import OutputError

PREFIX = ".mien-"
"""How the names of all temporary folders begin: whoever is killed leaves one behind."""
_REASONS = {
    errno.ENOSPC: "the disk is full; free some space or write elsewhere with -o",
    errno.EDQUOT: "the disk quota is used up; free some space or write elsewhere with -o",
    errno.EACCES: "permission denied; choose a folder you may write to with -o",
    errno.EPERM: "permission denied; choose a folder you may write to with -o",
    errno.EROFS: "the file system is read-only; choose another folder with -o",
    errno.ENOENT: "its folder does not exist; create it first",
    errno.ENOTDIR: "a file stands where its folder should be; choose another place with -o",
    errno.ENAMETOOLONG: "the name is too long; choose a shorter one with -o",
    errno.ENOTEMPTY: "a folder with other content is there already; choose another name with -o",
    errno.EEXIST: "a folder with other content is there already; choose another name with -o",
    errno.EISDIR: "a folder of that name is there already; choose another name with -o",
}


@contextmanager
def whole_file(path: Path) -> Iterator[Path]:
    """Give a temporary path beside ``path``; rename it to ``path`` when the block ends well.

    The temporary path keeps the suffix, for libraries that choose a format by it. On any
    exception, Ctrl-C included, nothing is left. Raises OutputError where the system refuses.
    """
    with _told(path), _beside(path) as room:
        temporary = room / path.name
        yield temporary
        temporary.replace(path)


@contextmanager
def whole_folder(path: Path) -> Iterator[Path]:
    """Give a temporary folder beside ``path``; rename it to ``path`` when the block ends well.

    An earlier result at ``path`` is replaced as a whole; a folder that holds files of other kinds
    than the new one is somebody's, and refused. Otherwise as ``whole_file``.
    """
    with _told(path), _beside(path) as room:
        temporary = room / path.name
        temporary.mkdir()
        yield temporary
        if not path.is_dir():
            temporary.rename(path)
            return
        if _kinds(path) - _kinds(temporary):
            raise OSError(errno.ENOTEMPTY, os.strerror(errno.ENOTEMPTY))
        earlier = path.rename(room / "earlier")
        try:
            temporary.rename(path)
        except BaseException:
            earlier.rename(path)
            raise


def _kinds(folder: Path) -> set[str]:
    return {entry.suffix for entry in folder.iterdir()}


@contextmanager
def _beside(path: Path) -> Iterator[Path]:
    """A hidden folder in the destination's own folder: a rename cannot cross file systems."""
    room = Path(tempfile.mkdtemp(prefix=PREFIX, dir=path.parent))
    try:
        yield room
    finally:
        shutil.rmtree(room, ignore_errors=True)


@contextmanager
def _told(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        reason = _REASONS.get(error.errno or 0, error.strerror or str(error))
        raise OutputError(f"cannot write {path}: {reason}") from error
