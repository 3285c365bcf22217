"""The detector's mesh of 468 landmarks: triangles, edge loops and mirror partners.

Loops of paired things are the subject's left one; ``mirrored`` gives the right. Loops round an eye
run from the outer corner over the top and back below, position k of each lying radially outside
position k of the one before; loops round the mouth run from the right corner over the top to the
left corner and back below.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Index = NDArray[np.intp]

_TABLE = json.loads((Path(__file__).parent / "data" / "landmark_mesh.json").read_text())

LANDMARKS = 468
TRIANGLES: Index = np.array(_TABLE["triangles"], dtype=np.intp)
"""(852, 3) counter-clockwise seen from outside; eyes and mouth are holes. Its own mirror image."""
MIRROR: Index = np.array(_TABLE["mirror"], dtype=np.intp)
"""(468,) the landmark on the other side; itself on the midline."""

_LOOPS: dict[str, Index] = {
    name: np.array(ids, dtype=np.intp) for name, ids in _TABLE["loops"].items()
}

SILHOUETTE = _LOOPS["silhouette"]
"""(36,) from the top of the forehead over the subject's left, under the chin and back."""
LID_LOOPS: Index = np.stack([_LOOPS[n] for n in ("lid_margin", "lid_roll", "lid_crease", "orbit")])
"""(4, 16) margin, roll, crease and orbit of the left eye."""
LIP_LOOPS: Index = np.stack(
    [_LOOPS[n] for n in ("lip_inner", "lip_second", "lip_third", "lip_border", "lip_outside")]
)
"""(5, 20) from the inner edge of the lips to the skin outside the vermilion border."""
BROW_UPPER, BROW_LOWER = _LOOPS["brow_upper"], _LOOPS["brow_lower"]
"""(5,) each: edges of the left brow, inner to outer end."""
NOSTRIL = _LOOPS["nostril"]
"""(7,) closed loop on the floor of the left nostril."""


def mirrored(landmarks: Index) -> Index:
    """The same landmarks on the other side."""
    return MIRROR[landmarks]
