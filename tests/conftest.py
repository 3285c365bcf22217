"""What tests of every room share."""

from __future__ import annotations

import pytest

from faces import toy_character
from mien.face.character import Character


@pytest.fixture(scope="session")
def toy_face() -> Character:
    return toy_character()
