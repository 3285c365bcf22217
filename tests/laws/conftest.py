"""A studio for the tests that ask one over HTTP."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from starlette.testclient import TestClient

    from mien.live.studio.shelf import Shelf


@pytest.fixture
def shelf(tmp_path: Path) -> Shelf:
    from mien.live.studio.shelf import Shelf

    return Shelf(tmp_path / "shelf")


@pytest.fixture
def client(shelf: Shelf, tmp_path: Path) -> Iterator[TestClient]:
    from starlette.testclient import TestClient

    from mien.live.studio.safety import LOOPBACK, Rules
    from mien.live.studio.server import studio

    with TestClient(studio(shelf, Rules(LOOPBACK | {"testserver"}), tmp_path)) as client:
        yield client
