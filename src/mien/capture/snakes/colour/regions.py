"""The eleven subareas whose mean brightness tells the network about light and skin [B] §3.1.

Named and placed in data/subareas.csv: forehead, cheek_right, cheek_left, brow_right, brow_left,
eye_right, eye_left, lids, nostrils, lip_upper, lip_lower.
"""

from __future__ import annotations

from functools import cache
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.colour.transform import Box, Field, window
from mien.capture.snakes.head.patch import COARSE

Array = NDArray[np.float64]


@cache
def subareas() -> dict[str, tuple[Box, ...]]:
    """Rectangles (left, top, right, bottom) in patch units of each subarea."""
    text = (files("mien.capture.snakes") / "data" / "subareas.csv").read_text(encoding="utf-8")
    found: dict[str, list[Box]] = {}
    for line in text.splitlines():
        name, *numbers = line.split(",")
        if len(numbers) == 4 and numbers[0].lstrip("-").isdigit():
            left, top, right, bottom = map(int, numbers)
            found.setdefault(name, []).append((left, top, right, bottom))
    return {name: tuple(boxes) for name, boxes in found.items()}


def means(brightness: Field) -> Array:
    """(11,) mean brightness of each subarea of a small patch (H / 2, W / 2), 0..255 and above."""
    values = []
    for boxes in subareas().values():
        windows = [window(box, COARSE) for box in boxes]
        cut = [brightness[top:bottom, left:right] for left, top, right, bottom in windows]
        values.append(sum(float(part.sum()) for part in cut) / sum(part.size for part in cut))
    return np.array(values)
