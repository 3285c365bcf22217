"""The rendered performer of a truth file as the tracker's person: the true mesh and its shapes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.track import KEPT
from mien.capture.tracker.chart import barycentric
from mien.capture.tracker.meet import ROWS
from mien.capture.tracker.person import Person, person
from mien.face.shape_space import ShapeSpace
from mien.numeric.raster import rasterize
from mien.vocabulary.landmarks import feature_points

Array = NDArray[np.float64]

MODEL_UNIT = 10.0
"""mm in one unit of the ICT model."""
SPREAD = 0.15
"""Prior standard deviation of the ICT shapes' weights."""
NEUTRAL = slice(0, 15)
"""Frames that are neutral, as the truth's README says."""
_FINE = 2
"""Samples a pixel when landmarks are put on the mesh."""


def true_space(truth: dict[str, Any], databank: Path) -> ShapeSpace:
    """The performer's own mesh with the 55 ICT shapes; no other identity is possible."""
    model = np.load(databank / "ict_face.npz", allow_pickle=False)
    count, narrow = len(truth["neutral"]), int(truth["narrow_count"])
    shapes = model["expr_q"][:, :count] * model["expr_scale"][:, None, None] * MODEL_UNIT
    quads = model["faces"][(model["faces"] < count).all(1) & (model["faces"][:, 3] >= 0)]
    triangles = np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]).astype(np.int32)
    middle = truth["eye_centre"].mean(0)
    return ShapeSpace(
        neutral=truth["neutral"].astype(float) - middle,
        triangles=triangles,
        narrow=(triangles < narrow).all(1),
        identity=np.zeros((0, count, 3)),
        expression=shapes,
        names=tuple(str(name) for name in model["expr_names"]),
        spread=np.full(len(shapes), SPREAD),
    )


def true_person(
    truth: dict[str, Any], databank: Path, landmarks: Array, focal: float, size: tuple[int, int]
) -> Person:
    """The performer, whose landmarks (F, N, 3) lie on the true mesh where they are seen in the
    neutral frames. The pose there is found from feature points, not taken from the truth."""
    space = true_space(truth, databank)
    usual = np.median(landmarks[NEUTRAL][:, ROWS, :2].astype(float), axis=0)
    ids = [str(fdp) for fdp in truth["fdp_ids"]]
    rows = {landmark: row for row, landmark in enumerate(np.array(KEPT)[ROWS].tolist())}
    pairs = [
        (int(truth["fdp_vertex"][ids.index(fdp)]), rows[landmark])
        for fdp, landmark in feature_points().items()
        if fdp in ids and landmark in rows
    ]
    vertex, row = np.array([pair for pair in pairs if pair[0] < len(space.neutral)]).T
    camera = np.array([[focal, 0, size[0] / 2], [0, focal, size[1] / 2], [0, 0, 1]])
    start = np.array([np.pi, 0.0, 0.0]), np.array([0.0, 0.0, 500.0])
    points = np.ascontiguousarray(usual[row])
    _, turn, shift = cv2.solvePnP(space.neutral[vertex], points, camera, None, *start, True)
    seen = space.neutral @ cv2.Rodrigues(turn)[0].T + shift.ravel()
    pixels = focal * seen[:, :2] / seen[:, 2:] + np.array(size) / 2.0
    screen = np.column_stack([pixels * _FINE, 1000.0 / seen[:, 2]]).astype(np.float32)
    flags = np.zeros(len(space.triangles), dtype=bool)
    hit, _ = rasterize(screen, space.triangles, flags, size[0] * _FINE, size[1] * _FINE)
    triangle = hit[(usual[:, 1] * _FINE).astype(int), (usual[:, 0] * _FINE).astype(int)]
    on_skin = triangle >= 0
    corners = space.triangles[triangle[on_skin]]
    shares = barycentric(pixels[corners], usual[on_skin])
    return person(space, space.neutral, (corners, shares), ROWS[on_skin], focal, size)


def surface_ratio(weights: Array, truth: dict[str, Any], space: ShapeSpace) -> float:
    """Dense error of the tracker's own surface over doing nothing, on the narrow face of the dense
    frames; ``weights`` (F, 55)."""
    narrow = int(truth["narrow_count"])
    true = (truth["dense_q"] * truth["dense_scale"] - truth["neutral"])[:, :narrow]
    guess = np.tensordot(weights[truth["dense_frames"]], space.expression[:, :narrow], axes=1)
    errors = np.linalg.norm(guess - true, axis=-1)
    return float(errors.mean() / np.linalg.norm(true, axis=-1).mean())
