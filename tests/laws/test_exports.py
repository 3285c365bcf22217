"""What ``import mien`` promises is there."""

from __future__ import annotations

import mien


def test_every_promised_name_is_there() -> None:
    assert mien.__all__ == sorted(mien.__all__)
    assert all(getattr(mien, name) is not None for name in mien.__all__)
    assert callable(mien.capture), "the room of the same name must not hide the function"
