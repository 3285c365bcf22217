"""What looks wrong about an imported face."""

from __future__ import annotations

import numpy as np

from mien.face.model import Model
from mien.rig.importer import Import

_OPEN = 0.15
"""Part of the mouth's width by which lips gape at neutral."""
_PARTS = 0.03
"""Part of it by which a shape must part the lips, to open the mouth."""


_FOLDED = 0.01
"""Part of the edges that may belong to more than two triangles without being spoken of."""


def doubts(found: Import, model: Model) -> list[str]:
    """One line each, for a person to read."""
    told = []
    origin = found.character.origin
    eyes = model.hooks.eyes if origin is None else origin.hooks.eyes
    shown = found.character.looks
    if found.facing < 0:
        told.append("faces -z: turned round")
    face, keys = found.character.face, found.character.keys
    upper, lower = face.points.index(("2.2", "2.3"))
    mouth = float(np.linalg.norm(face.point("8.3") - face.point("8.4")))
    if face.point("2.2")[1] - face.point("2.3")[1] > _OPEN * mouth:
        told.append("the mouth is open at neutral")
    motion = face.points.at(keys.displacements)
    parted = motion[:, upper, 1] - motion[:, lower, 1]
    if not len(parted):
        told.append("has no shapes: make some with 'mien character make'")
    elif parted.max() < _PARTS * mouth:
        told.append("no shape parts the lips: the mouth has no opening, or lip points are off")
    folded = _folded(model)
    if folded > _FOLDED:
        told.append(
            f"{folded:.0%} of its edges belong to more than two triangles: no clean surface"
        )
    if len(keys.names) and not found.character.blinks:
        told.append("no two shapes were found that shut one eye each: lids follow points only")
    if not any(part.follows.startswith("eye") for part in face.parts) and not shown:
        told.append("no eyeballs were found: previews show no gaze")
    if model.source is not None:
        if None in eyes and not shown:
            told.append(
                "no nodes were found that turn the eyes: the written file shows no gaze; name them "
                "in a --map file under [nodes]"
            )
        if model.hooks.head is None and any(part.node is not None for part in model.parts):
            told.append("no node was found that turns the head: the written file turns as a whole")
    return told


def _folded(model: Model) -> float:
    """Part of a model's edges that belong to more than two triangles."""
    triangles = model.triangles
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, 1:], triangles[:, [2, 0]]]))
    _, count = np.unique(edges, axis=0, return_counts=True)
    return float((count > 2).mean())
