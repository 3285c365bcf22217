"""The landmarks of the face detector (MediaPipe FaceMesh with irises) in the field's terms.

Indices 0 to 467 are the face, 468 to 477 the irises. Left and right are the subject's.
"""

from __future__ import annotations

from functools import cache
from importlib.resources import files

FACE_LANDMARKS = 468
ALL_LANDMARKS = 478

RIGID = (
    4, 6, 10, 33, 54, 67, 117, 119, 121, 127, 129, 132, 133, 136, 143, 147, 198, 205,
    263, 284, 297, 346, 348, 350, 356, 358, 361, 362, 365, 372, 376, 420, 425,
)  # fmt: skip
"""What MediaPipe's own geometry pipeline takes for the head's pose (Apache-2.0)."""

IRIS = (473, 468)
"""Iris centre of the left and the right eye."""
EYE_CORNERS = ((263, 362), (33, 133))
"""(outer, inner) of the left and the right eye."""
UPPER_LID = ((386, 385, 387), (159, 158, 160))
LOWER_LID = ((374, 380, 373), (145, 153, 144))
"""Three points along each margin, of the left and the right eye; partners have the same place."""

IBUG = (
    162, 234, 93, 58, 172, 136, 149, 148, 152, 377, 378, 365, 397, 288, 323, 454, 389,
    71, 63, 105, 66, 107, 336, 296, 334, 293, 301,
    168, 197, 5, 4, 75, 97, 2, 326, 305,
    33, 160, 158, 133, 153, 144, 362, 385, 387, 263, 373, 380,
    61, 39, 37, 0, 267, 269, 291, 405, 314, 17, 84, 181,
    78, 82, 13, 312, 308, 317, 14, 87,
)  # fmt: skip
"""The landmark nearest to each of iBUG's sixty-eight points: jaw from the subject's right ear,
brows, nose, eyes, outer and inner lips."""

_SLIDING = frozenset(
    ("2.11", "2.12", "2.13", "2.14", "10.7", "10.8", "10.9", "10.10", "11.1", "11.2", "11.3")
)
_PUPILS = frozenset(("3.5", "3.6"))


@cache
def feature_points() -> dict[str, int]:
    """FDP id -> landmark for the 53 points that stay on their piece of skin when the head turns
    (silhouettes slide, pupils are the gaze's)."""
    text = (files("mien.vocabulary") / "data" / "detector_fdp.csv").read_text(encoding="utf-8")
    rows = [line.split(",") for line in text.splitlines() if line and line[0].isdigit()]
    return {fdp: int(index) for fdp, index, _ in rows if fdp not in _SLIDING | _PUPILS}
