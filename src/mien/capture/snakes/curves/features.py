"""The features that are followed: where each is looked for, and what it looks like at rest.

Places are patch units: origin midway between the eyes (an eye is the middle of its corners), x to
the picture's right, y down, the eyes 100 apart. So a unit is a hundredth of the eyes' distance.
Left and right in names are the subject's: the right eye is on the picture's left.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.head.patch import COARSE

Array = NDArray[np.float64]

EYES_APART = 100.0


@dataclass(frozen=True, slots=True)
class Feature:
    """One lens to follow."""

    name: str
    group: str
    """Key of the colour transformation it is sought in: "brow", "eye", "nostril" or "lip"."""
    box: tuple[int, int, int, int]
    """Left, top, right, bottom of its anthropometric rectangle."""

    @property
    def pitch(self) -> int:
        """Patch units from one pixel to the next where it is sought: only lids and nostrils are
        fine enough to need every pixel of the patch."""
        return 1 if self.group in ("eye", "nostril") else COARSE


FEATURES = (
    Feature("eye_right", "eye", (-84, -22, -16, 18)),
    Feature("eye_left", "eye", (16, -22, 84, 18)),
    Feature("brow_right", "brow", (-104, -68, -4, -10)),
    Feature("brow_left", "brow", (4, -68, 104, -10)),
    Feature("nostril_right", "nostril", (-40, 46, -2, 84)),
    Feature("nostril_left", "nostril", (2, 46, 40, 84)),
    Feature("lips", "lip", (-66, 80, 66, 189)),
)
"""In the order in which they are sought: brows lie above the eyes that were found."""
NAMES = tuple(feature.name for feature in FEATURES)
ROW = {name: row for row, name in enumerate(NAMES)}


LASTING = np.array([feature.group != "nostril" for feature in FEATURES])
"""(L,) what every face shows; nostrils hide as soon as a head bows."""

MOUTH = len(FEATURES)
"""Row of the mouth's opening, which is found inside the lips."""


@cache
def usual_lenses() -> dict[str, Array]:
    """(6, 2) each: the features and the mouth's opening of a resting face, the middle of several
    adults."""
    text = (files("mien.capture.snakes") / "data" / "usual_lenses.csv").read_text(encoding="utf-8")
    rows = (line.split(",") for line in text.splitlines() if not line.startswith(("#", "feature")))
    return {name: np.array(numbers, dtype=float).reshape(6, 2) for name, *numbers in rows}


def usual_features() -> Array:
    """(L, 6, 2) those of FEATURES, in their order."""
    return np.stack([usual_lenses()[name] for name in NAMES])
