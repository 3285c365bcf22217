"""The faces of the ICT world as databanks, for benchmarks that are given its files.

``ict_face.npz``, ``points.json`` and ``databank25.json`` stand in one folder.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from mien.face.databank import Databank
from mien.face.face import Face, FeaturePoints, Material, Part

Array = NDArray[np.float64]
NARROW = 6706
"""Vertices of the narrow face, which come first."""


def read_bank(folder: Path, shapes: bool = False) -> Databank:
    """The narrow face of the generic person with its 25 faces, or with all ``shapes``."""
    with np.load(folder / "ict_face.npz") as data:
        unit = float(data["unit_mm"])
        steps, scales = data["expr_q"][:, :NARROW], data["expr_scale"][:, None, None]
        names = tuple(str(name) for name in data["expr_names"])
        neutral = data["neutral"].astype(float) * unit
        quads = data["faces"][: int(data["narrow_face"][1])]
    fields = steps.astype(np.float32) * np.float32(unit) * scales.astype(np.float32)
    if not shapes:
        faces = json.loads((folder / "databank25.json").read_text("utf-8"))["faces"]
        mix = np.array([[face["weights"].get(n, 0.0) for n in names] for face in faces.values()])
        fields, names = np.tensordot(mix.astype(np.float32), fields, axes=1), tuple(faces)
    return Databank("ict", _face(folder, neutral, quads), names, fields)


def _face(folder: Path, neutral: Array, quads: NDArray[np.int32]) -> Face:
    four = quads[quads[:, 3] >= 0]
    triangles = np.concatenate([quads[:, :3], four[:, [0, 2, 3]]]).astype(np.int32)
    points = json.loads((folder / "points.json").read_text("utf-8"))["fdp"]
    rows = {fdp: int(p["vertex"]) for fdp, p in points.items() if p["vertex"] < NARROW}
    corners = np.repeat(np.array(list(rows.values()), dtype=np.int32)[:, None], 3, axis=1)
    middle = np.zeros(3)
    return Face(
        vertices=neutral[:NARROW],
        parts=(Part("skin", "skin", 0, NARROW, triangles),),
        materials={"skin": Material()},
        colours=np.full((NARROW, 3), 0.5),
        occlusion=np.ones(NARROW),
        points=FeaturePoints(tuple(rows), corners, np.tile([1.0, 0.0, 0.0], (len(rows), 1))),
        pivots=dict.fromkeys(("head", "jaw", "eye_left", "eye_right"), middle),
    )
