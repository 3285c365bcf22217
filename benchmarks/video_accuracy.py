"""How far a captured performance is from a known truth.

    python benchmarks/video_accuracy.py --clip CLIP.mp4 --truth CLIP_truth.npz [--json]

Head rotation in degrees after one constant alignment, motion of feature points, and the dense
surface when the capture drives 25 faces on the performer's true neutral; beside plain PnP and
doing nothing. CLIP_truth.npz and the faces (databank25.json, ict_face.npz, points.json in
--databank) are those of a rendered performer on the ICT-FaceKit mesh.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

import mien
from mien.capture.detector import follow
from mien.capture.landmarks import WORLD_FROM_CAMERA
from mien.capture.track import ROW, LandmarkTrack
from mien.face.character import Character, KeyModels
from mien.face.face import Face, FeaturePoints, Material, Part
from mien.face.library import generic_face
from mien.face.pieces import split
from mien.formats.sources import open_source
from mien.numeric.rotation import angle_between
from mien.performance.performance import Performance
from mien.vocabulary.landmarks import RIGID
from report import show

Array = NDArray[np.float64]

MODEL_UNIT = 10.0
"""mm in one unit of the ICT model."""
MOVING = 1.0
"""mm beyond which a feature point counts as moving."""


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--clip", type=Path, required=True)
    parser.add_argument("--truth", type=Path, required=True)
    parser.add_argument(
        "--databank", type=Path, help="folder of the faces (beside --truth: ../ict)"
    )
    parser.add_argument("--capture", default="landmarks")
    parser.add_argument("--mapping", default="cardinal")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    databank = options.databank or options.truth.resolve().parent.parent / "ict"

    truth = dict(np.load(options.truth, allow_pickle=False))
    performance = mien.capture(options.clip, method=options.capture)
    mean, p95 = rotation_error(WORLD_FROM_CAMERA @ performance.rotation, truth["R"])
    pnp_mean, pnp_p95 = rotation_error(*pnp(options.clip, truth))
    still, _ = rotation_error(np.broadcast_to(np.eye(3), truth["R"].shape), truth["R"])
    error, moved = feature_error(performance, truth)
    ratio, amplitude = dense_error(performance, truth, databank, options.mapping)
    figures = {
        "rotation_mean_deg": mean,
        "rotation_p95_deg": p95,
        "pnp_rotation_mean_deg": pnp_mean,
        "pnp_rotation_p95_deg": pnp_p95,
        "nothing_rotation_mean_deg": still,
        "fdp_moving_mm": error,
        "fdp_moving_nothing_mm": moved,
        "fdp_moving_ratio": error / moved,
        "dense_ratio": ratio,
        "amplitude": amplitude,
    }
    show("video_accuracy", f"Accuracy on {options.clip.name}", figures, options.json)


def rotation_error(estimated: Array, true: Array) -> tuple[float, float]:
    """Mean and 95 % quantile in degrees of (F, 3, 3) after one constant turn of the head frame."""
    left, _, right = np.linalg.svd(np.einsum("fji,fjk->ik", true, estimated))
    align = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
    error = np.degrees(angle_between(true @ align, estimated))
    return float(error.mean()), float(np.quantile(error, 0.95))


def pnp(clip: Path, truth: dict[str, Any]) -> tuple[Array, Array]:
    """Plain PnP of the generic face's rigid points with the true camera: (F, 3, 3) and the truth
    of the same frames."""
    track: LandmarkTrack = follow(open_source(clip))
    model = generic_face().face.vertices[list(RIGID)]
    rows = [ROW[i] for i in RIGID]
    turns = []
    for points in track.points[:, rows, :2].astype(float):
        start = np.array([np.pi, 0.0, 0.0]), np.array([0.0, 0.0, 500.0])
        picture = np.ascontiguousarray(points)
        _, turn, _ = cv2.solvePnP(model, picture, truth["K"], None, *start, True)
        turns.append(cv2.Rodrigues(turn)[0])
    return np.array(turns)[~track.lost], truth["R"][~track.lost]


def feature_error(performance: Performance, truth: dict[str, Any]) -> tuple[float, float]:
    """Mean error and mean true motion, mm, of feature points that truly move."""
    ids = [str(fdp) for fdp in truth["fdp_ids"]]
    shared = [fdp for fdp in performance.points if fdp in ids]
    places = truth["fdp_head"][:, [ids.index(fdp) for fdp in shared]]
    true = places - places[:15].mean(0)
    motion = performance.motion[:, [performance.points.index(fdp) for fdp in shared]]
    size = np.linalg.norm(true, axis=-1)
    moving = size > MOVING
    error = np.linalg.norm(motion - true, axis=-1)
    return float(error[moving].mean()), float(size[moving].mean())


def dense_error(
    performance: Performance, truth: dict[str, Any], databank: Path, mapping: str
) -> tuple[float, float]:
    """Dense error over doing nothing, and amplitude, on the narrow face of the dense frames."""
    character = true_character(truth, databank)
    curves = mien.animate(performance, character, mapping=mapping, smooth=False)
    pieces = split(character)
    narrow = int(truth["narrow_count"])
    frames = truth["dense_frames"]
    true = truth["dense_q"] * truth["dense_scale"] - truth["neutral"]
    errors, moved, along, size = [], [], 0.0, 0.0
    for frame, motion in zip(frames, true[:, :narrow], strict=True):
        guess = np.tensordot(curves.weights[frame], pieces.displacements[:, :narrow], axes=1)
        errors.append(np.linalg.norm(guess - motion, axis=-1).mean())
        moved.append(np.linalg.norm(motion, axis=-1).mean())
        along += float((guess * motion).sum())
        size += float((motion**2).sum())
    return float(np.mean(errors) / np.mean(moved)), along / size


def true_character(truth: dict[str, Any], databank: Path) -> Character:
    """The 25 faces of the databank on the performer's true neutral."""
    model = np.load(databank / "ict_face.npz", allow_pickle=False)
    faces = json.loads((databank / "databank25.json").read_text())["faces"]
    names = [str(name) for name in model["expr_names"]]
    count = len(truth["neutral"])
    shapes = model["expr_q"][:, :count] * model["expr_scale"][:, None, None] * MODEL_UNIT
    fields = [
        sum(w * shapes[names.index(shape)] for shape, w in face["weights"].items())
        for face in faces.values()
    ]
    eyes = truth["eye_centre"]
    middle = eyes.mean(0)
    inside = truth["fdp_vertex"] < count
    vertex = truth["fdp_vertex"][inside].astype(np.int32)
    points = FeaturePoints(
        tuple(str(fdp) for fdp in truth["fdp_ids"][inside]),
        np.repeat(vertex[:, None], 3, axis=1),
        np.tile([1.0, 0.0, 0.0], (len(vertex), 1)),
    )
    quads = model["faces"][(model["faces"] < count).all(1) & (model["faces"][:, 3] >= 0)]
    triangles = np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]]).astype(np.int32)
    face = Face(
        vertices=truth["neutral"].astype(float) - middle,
        parts=(Part("skin", "skin", 0, count, triangles),),
        materials={"skin": Material()},
        colours=np.ones((count, 3)),
        occlusion=np.ones(count),
        points=points,
        pivots={
            "eye_left": eyes[0] - middle,
            "eye_right": eyes[1] - middle,
            "jaw": np.zeros(3),
            "head": np.zeros(3),
        },
    )
    keys = KeyModels(tuple(faces), np.array(fields, dtype=np.float32))
    return Character("true", face, keys, tuple(faces))


if __name__ == "__main__":
    main()
