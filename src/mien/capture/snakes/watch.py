"""What the snakes saw, for people who want to look over their shoulder."""

from __future__ import annotations

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.colour.glow import dimmed
from mien.capture.snakes.colour.transform import window
from mien.capture.snakes.curves.features import FEATURES, NAMES, ROW
from mien.capture.snakes.curves.fields import field_of
from mien.capture.snakes.curves.lens import lower_curve, upper_curve
from mien.capture.snakes.head.patch import HEIGHT, WIDTH
from mien.capture.snakes.iris import RADIUS
from mien.capture.snakes.seen import Seen
from mien.performance.trace import Trace

Array = NDArray[np.float64]

_BLACK = np.zeros((HEIGHT, WIDTH, 3), dtype=np.uint8)
_AXIS = 60.0
"""Patch units."""
_ROUND = np.linspace(0.0, 2.0 * np.pi, 17)
_IRIS = RADIUS * np.stack([np.cos(_ROUND), np.sin(_ROUND)], axis=1)


def trace_of(seen: Seen | None) -> Trace:
    """Curves that were found, rectangles, head axes, and the transformed picture beside."""
    if seen is None:
        return Trace(lost=True, notes=("lost",), beside=_BLACK)
    curves = {}
    found = [*(~seen.lost), not seen.lost[ROW["lips"]]]
    for row, name in enumerate((*NAMES, "mouth")):
        if not found[row]:
            continue
        for edge, curve in (("upper", upper_curve), ("lower", lower_curve)):
            curves[f"{name}_{edge}"] = seen.placement.to_frame(curve(seen.lenses[row]))
    boxes = {}
    for feature in FEATURES:
        left, top, right, bottom = feature.box
        corners = np.array([[left, top], [right, top], [right, bottom], [left, bottom]])
        boxes[feature.name] = seen.placement.to_frame(corners.astype(float))
    for side, middle in zip(("right", "left"), seen.irises.places, strict=True):
        curves[f"iris_{side}"] = seen.placement.to_frame(middle + _IRIS)
    tips = np.array([[0, 0, 0], [1, 0, 0], [0, -1, 0], [0, 0, -1]]) * _AXIS
    notes = [f"{name} lost" for name, gone in zip(NAMES, seen.lost, strict=True) if gone]
    return Trace(
        curves=curves,
        boxes=boxes,
        points=seen.placement.to_frame(seen.rigid),
        axes=seen.placement.to_frame(seen.pose(tips)),
        beside=_transformed(seen),
        notes=(*notes, *(["recovered"] if seen.recovered else [])),
    )


def _transformed(seen: Seen) -> NDArray[np.uint8]:
    """(HEIGHT, WIDTH, 3) the fields in their rectangles, and the dim patch round them."""
    picture = np.repeat(seen.grey[..., None] // 4, 3, axis=2)
    for feature in FEATURES:
        left, top, right, bottom = window(feature.box)
        field = field_of(seen.look, feature, seen.weights)
        if feature.group == "lip":
            field = dimmed(field, seen.glow)
        whole = cv2.resize((field * 255.0).astype(np.uint8), (right - left, bottom - top))
        picture[top:bottom, left:right] = whole[..., None]
    return picture
