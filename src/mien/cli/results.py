"""Where a command's results go: all of them, or none."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from mien.cli.interruption import check
from mien.errors import InputError, OutputError


@contextmanager
def results(folder: Path) -> Iterator[Callable[[str], Path]]:
    """Make ``folder`` and give a function that names results in it.

    Whether one may write there is known before the work begins. When the block fails, Ctrl-C
    included, what it added is taken away again. Raises OutputError.
    """
    made: list[Path] = []
    added: list[Path] = []

    def claim(name: str) -> Path:
        path = folder / name
        if not path.exists():
            added.append(path)
        return path

    try:
        _prepare(folder, made)
        yield claim
        check()
    except BaseException:
        for path in added:
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink(missing_ok=True)
        for path in reversed(made):
            with suppress(OSError):
                path.rmdir()
        raise


def spare(take: str, files: Iterable[Path]) -> None:
    """Raise InputError where a result would take the place of what it is made from."""
    for file in files:
        if file.exists() and Path(take).exists() and file.samefile(take):
            raise InputError(f"-o {file}: that is the take itself; choose another name")


def _prepare(folder: Path, made: list[Path]) -> None:
    missing = [path for path in (folder, *folder.parents) if not path.exists()]
    try:
        for path in reversed(missing):
            path.mkdir()
            made.append(path)
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise OutputError(
            f"cannot write into {folder}: {reason}; choose another folder with -o"
        ) from error
