"""A face in ARKit's words as the points that OpenSeeFace would have seen of it."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from mien.face.library import generic_face
from mien.formats.streams.openseeface import FEATURES, PLACES, POINTS, SeenFace
from mien.numeric.rotation import from_gaze
from mien.performance.arkit_frame import ArkitFrame
from mien.vocabulary.arkit import names
from mien.vocabulary.landmarks import IBUG

Array = NDArray[np.float64]

_SIZE, _FOCAL, _DISTANCE = (640, 480), 700.0, 600.0
"""The camera that is made up: pixels, pixels, mm."""
_CAMERA_FROM_WORLD = np.diag([1.0, -1.0, -1.0])
_INNER_CORNERS = (60, 64)
"""The two of iBUG's sixty-eight that OpenSeeFace leaves out."""
_EYE_RADIUS = 12.0


@cache
def _points() -> tuple[Array, Array]:
    """Places (66, 3) and fields (52, 66, 3) of OpenSeeFace's points on the generic face."""
    generic = generic_face()
    chosen = [landmark for i, landmark in enumerate(IBUG) if i not in _INNER_CORNERS]
    fields = np.stack([generic.keys[name][chosen] for name in names()])
    return generic.face.vertices[chosen], fields.astype(float)


def seen_face(frame: ArkitFrame) -> SeenFace:
    """``frame`` on the generic face, half a metre before a camera that is made up."""
    places, fields = _points()
    pivots = generic_face().face.pivots
    eyes = np.stack([pivots["eye_right"], pivots["eye_left"]])
    ahead = from_gaze(frame.gaze[::-1])[:, :, 2]
    skin = places + np.tensordot(frame.shapes, fields, axes=1)
    whole = np.concatenate([skin, eyes + _EYE_RADIUS * ahead, eyes])
    assert whole.shape == (PLACES, 3)
    rotation = _CAMERA_FROM_WORLD @ frame.rotation
    translation = _CAMERA_FROM_WORLD @ frame.translation + [0.0, 0.0, _DISTANCE]
    seen = whole[:POINTS] @ rotation.T + translation
    picture = _FOCAL * seen[:, :2] / seen[:, 2:] + np.array(_SIZE) / 2.0
    weight = dict(zip(names(), frame.shapes.tolist(), strict=True))
    return SeenFace(
        time=frame.time,
        size=_SIZE,
        openness=(1.0 - weight["eyeBlinkLeft"], 1.0 - weight["eyeBlinkRight"]),
        seen=frame.seen,
        rotation=rotation,
        translation=translation,
        picture=picture,
        places=whole,
        features=_features(weight),
    )


def _features(weight: dict[str, float]) -> Array:
    """(14,) OpenSeeFace's own words for eyes, brows and mouth, -1..1."""
    told = []
    for side in ("Left", "Right"):
        told.append(weight[f"eyeWide{side}"] - weight[f"eyeBlink{side}"])
    for side in ("Left", "Right"):
        up, outer, down = (
            weight["browInnerUp"],
            weight[f"browOuterUp{side}"],
            weight[f"browDown{side}"],
        )
        told += [outer - up, 0.5 * (up + outer) - down, outer - 0.5 * (up + down)]
    for side in ("Left", "Right"):
        told.append(weight[f"mouthSmile{side}"] - weight[f"mouthFrown{side}"])
        told.append(weight[f"mouthStretch{side}"] - weight["mouthPucker"])
    smile = 0.5 * (weight["mouthSmileLeft"] + weight["mouthSmileRight"])
    told += [weight["jawOpen"], smile - weight["mouthPucker"]]
    assert len(told) == FEATURES
    return np.clip(told, -1.0, 1.0)
