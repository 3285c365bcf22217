"""What Live Link Face carries besides the ARKit shapes, and in which order.

The stream and the recorded CSV differ at four places: the CSV has JawRight before JawLeft and
MouthRight before MouthLeft, the stream (Unreal's EARFaceBlendShape) the other way round. In four
recorded takes the place that Unreal calls MouthLeft moved with the left half of the mouth, whatever
the header said, so one of the two names a side wrongly: whoever reads may ask for a swap.
Sources: as named in data/arkit.csv.
"""

from __future__ import annotations

from mien.vocabulary.arkit import face_shapes, names, pascal

ANGLES = (
    "HeadYaw",
    "HeadPitch",
    "HeadRoll",
    "LeftEyeYaw",
    "LeftEyePitch",
    "LeftEyeRoll",
    "RightEyeYaw",
    "RightEyePitch",
    "RightEyeRoll",
)
"""Radians."""

FRAMES_PER_SECOND = 60
"""Of time codes and frame numbers, also when the phone ran at 30 and skipped every other."""

SIDEWAYS = (("jawLeft", "jawRight"), ("mouthLeft", "mouthRight"))
"""Shapes whose sides are in doubt, see above."""


def stream_columns() -> tuple[str, ...]:
    """(61) values of a datagram, in order."""
    return (*map(pascal, names()), *ANGLES)


def csv_columns() -> tuple[str, ...]:
    """(61) values of a CSV row after the time code and the count, in order."""
    shapes = sorted(face_shapes().values(), key=lambda shape: shape.csv)
    return (*(pascal(shape.name) for shape in shapes), *ANGLES)
