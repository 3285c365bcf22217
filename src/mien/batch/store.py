"""Where a batch keeps what it made: under names made of content, each whole or not there.

    captures/KEY/   the performance of a take, pictures of it, and an account
    results/KEY/    what a character made of it
    takes/NAME/     the same results again (as links), under the names people gave

The first two say what is done: whoever finds a key there need not compute it. An account holds no
times, so that the same work gives the same bytes.
"""

from __future__ import annotations

import json
import os
import shutil
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from mien.errors import InputError, OutputError
from mien.formats.atomic import PREFIX, whole_file, whole_folder

if sys.platform != "win32":
    import fcntl

ACCOUNT = "account.json"
PERFORMANCE = "performance.mien"
PICTURE = "picture.jpg"


@dataclass(frozen=True, slots=True)
class Store:
    """A folder that a batch, its workers and later batches share."""

    root: Path

    @property
    def captures(self) -> Path:
        return self.root / "captures"

    @property
    def results(self) -> Path:
        return self.root / "results"

    @property
    def takes(self) -> Path:
        return self.root / "takes"

    @property
    def workers(self) -> Path:
        """Where workers of this machine keep things of their own while they live."""
        return self.root / f"{PREFIX}workers"

    @contextmanager
    def opened(self) -> Iterator[None]:
        """Make the folders, keep other batches out, and clear away what killed ones left.

        Raises OutputError where the folder cannot be used or is in use.
        """
        try:
            for folder in (self.captures, self.results, self.takes):
                folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            reason = (error.strerror or str(error)).lower()
            raise OutputError(f"cannot write into {self.root}: {reason}; choose another") from error
        with self._alone():
            self.sweep()
            try:
                yield
            finally:
                self.sweep()

    def sweep(self) -> None:
        """Remove what was begun and not finished. Only for who is alone here."""
        for folder in (self.root, self.captures, self.results, self.takes, *_folders(self.takes)):
            for left in folder.glob(f"{PREFIX}*"):
                shutil.rmtree(left, ignore_errors=True)

    @contextmanager
    def _alone(self) -> Iterator[None]:
        """The system lets go of the lock however its holder ends."""
        if sys.platform == "win32":
            yield
            return
        held = os.open(self.root, os.O_RDONLY)
        try:
            fcntl.flock(held, fcntl.LOCK_EX | fcntl.LOCK_NB)
            yield
        except BlockingIOError as error:
            raise OutputError(
                f"{self.root}: another batch is writing there; wait for it or choose another"
            ) from error
        finally:
            os.close(held)

    def publish(self, key: str, take: str) -> None:
        """Give the results of ``key`` the names under which people look for them."""
        folder = self.takes / take
        folder.mkdir(exist_ok=True)
        for name in self.made(key):
            _link(self.results / key / name, folder / name)

    def made(self, key: str) -> list[str]:
        """Names of the files and folders that are the result ``key``."""
        entries = (self.results / key).iterdir()
        return sorted(entry.name for entry in entries if entry.name not in (ACCOUNT, PICTURE))


@contextmanager
def kept(path: Path, account: dict[str, Any]) -> Iterator[Path]:
    """A folder to fill, which becomes ``path`` with ``account`` in it when the block ends well."""
    with whole_folder(path) as room:
        yield room
        text = json.dumps(account, indent=1, sort_keys=True)
        (room / ACCOUNT).write_text(f"{text}\n", "utf-8")


def account_of(path: Path) -> dict[str, Any]:
    """What was written of a finished ``path``. Raises InputError where it was damaged since."""
    try:
        account = json.loads((path / ACCOUNT).read_text("utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(
            f"{path}: its {ACCOUNT} cannot be read; remove that folder and run the batch again"
        ) from error
    return dict(account)


def _folders(folder: Path) -> list[Path]:
    return [entry for entry in folder.iterdir() if entry.is_dir()]


def _link(made: Path, path: Path) -> None:
    """One content under two names; a copy where the file system knows no links."""
    if made.is_dir():
        with whole_folder(path) as room:
            shutil.copytree(made, room, copy_function=_same, dirs_exist_ok=True)
    elif not (path.exists() and path.samefile(made)):
        with whole_file(path) as temporary:
            _same(str(made), str(temporary))


def _same(made: str, path: str) -> None:
    with suppress(OSError):
        os.link(made, path)
        return
    shutil.copyfile(made, path)
