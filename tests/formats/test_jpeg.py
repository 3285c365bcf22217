"""Pictures of cameras and pages: colours stay, and nothing hostile is laid out."""

from __future__ import annotations

from contextlib import suppress

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clips import quarters
from mien.errors import FormatError
from mien.formats.pictures.jpeg import LARGEST_SIDE, decode_jpeg, encode_jpeg

REAL = encode_jpeg(quarters(), 48, quality=95)


def test_colours_come_back() -> None:
    assert np.abs(decode_jpeg(REAL).astype(int) - quarters()).mean() < 6.0


def test_a_picture_that_says_it_is_huge_is_not_laid_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cv2, "imdecode", lambda *_: pytest.fail("it was decoded"))
    place = REAL.index(b"\xff\xc0") + 5
    for size in ((LARGEST_SIDE + 1, 10), (10, 65535), (0, 0)):
        claim = b"".join(side.to_bytes(2) for side in size)
        with pytest.raises(FormatError, match="cannot be used"):
            decode_jpeg(REAL[:place] + claim + REAL[place + 4 :])


@settings(deadline=None)
@given(st.data())
def test_hostile_pictures_are_refused_or_read(data: st.DataObject) -> None:
    broken = bytearray(REAL)
    for place in data.draw(st.lists(st.integers(0, len(REAL) - 1), max_size=5)):
        broken[place] = data.draw(st.integers(0, 255))
    end = data.draw(st.integers(0, len(REAL)))
    with suppress(FormatError):
        assert max(decode_jpeg(bytes(broken[:end])).shape) <= LARGEST_SIDE
