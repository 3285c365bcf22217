"""How far a captured performance is from a known truth.

    python benchmarks/video_accuracy.py --clip CLIP.mp4 --truth CLIP_truth.npz [--json]
    ... --capture landmarks
    ... --focal truth [--person truth] [--occluder] [--ablation]

Head rotation in degrees after one constant alignment, motion of feature points, and the dense
surface when the capture drives 25 faces on the performer's true neutral; beside plain PnP and
doing nothing. CLIP_truth.npz and the faces (databank25.json, ict_face.npz, points.json in
--databank) are those of a rendered performer on the ICT-FaceKit mesh.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

import mien
from mien.capture import CAPTURES, CaptureSettings
from mien.capture.detector import follow
from mien.capture.landmarks import USUAL_FOCAL, WORLD_FROM_CAMERA, calibrate, rest_of
from mien.capture.landmarks import perform as from_landmarks
from mien.capture.neutral import ground
from mien.capture.track import ROW, LandmarkTrack
from mien.capture.tracker.capture import Faces, follow_take
from mien.capture.tracker.meet import generic_person
from mien.capture.tracker.perform import perform
from mien.capture.tracker.trust import Trust
from mien.face.character import Character, KeyModels
from mien.face.face import Face, FeaturePoints, Material, Part
from mien.face.library import generic_face
from mien.face.targets import targets
from mien.formats.pictures.sources import open_source
from mien.numeric.rotation import angle_between
from mien.performance.frame import Frame
from mien.performance.performance import Performance
from mien.vocabulary.landmarks import RIGID
from report import show
from true_person import NEUTRAL, surface_ratio, true_person

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
    parser.add_argument("--capture", default="tracker")
    parser.add_argument("--mapping", default="cardinal")
    parser.add_argument(
        "--focal", default="unknown", help="truth, unknown, or pixels (default: %(default)s)"
    )
    parser.add_argument(
        "--person",
        choices=("own", "truth"),
        default="own",
        help="truth: the tracker is given the true mesh and shapes",
    )
    parser.add_argument(
        "--occluder", action="store_true", help="paint a hand-sized thing that passes the face"
    )
    parser.add_argument(
        "--ablation", action="store_true", help="the tracker with each of its terms left out"
    )
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    databank = options.databank or options.truth.resolve().parent.parent / "ict"

    truth = dict(np.load(options.truth, allow_pickle=False))
    focal = focal_length(options.focal, truth)
    if options.ablation:
        ablation(options, truth, focal)
        return
    if options.person == "truth":
        figures = with_true_person(options, truth, databank, focal)
        show("video_accuracy", f"Accuracy on {options.clip.name}", figures, options.json)
        return
    performance = CAPTURES[options.capture](
        pictures(options), CaptureSettings(focal=focal), options.clip.name
    )
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


def focal_length(said: str, truth: dict[str, Any]) -> float | None:
    """Pixels, or None where nobody knows."""
    if said == "unknown":
        return None
    return float(truth["K"][0, 0]) if said == "truth" else float(said)


def pictures(options: argparse.Namespace) -> Iterable[Frame]:
    """The clip, or the clip with something before it."""
    return occluded(open_source(options.clip)) if options.occluder else open_source(options.clip)


def occluded(frames: Iterable[Frame]) -> Iterator[Frame]:
    """A striped disc of a fist's size that crosses the face from side to side again and again, two
    seconds of three."""
    for number, frame in enumerate(frames):
        image = frame.image.copy()
        height, width = image.shape[:2]
        phase = number % 90
        if phase < 60:
            centre = (
                width * (0.3 + 0.4 * phase / 60.0),
                height * (0.62 - 0.1 * (number % 180 > 89)),
            )
            y, x = np.mgrid[:height, :width]
            disc = (x - centre[0]) ** 2 + (y - centre[1]) ** 2 < (0.11 * height) ** 2
            stripes = (140 + 40 * np.sin((x + 0.5 * y) / 9.0))[disc]
            image[disc] = np.stack([stripes, 0.8 * stripes, 0.65 * stripes], axis=1)
        yield Frame(image, frame.time)


def watched(options: argparse.Namespace) -> tuple[LandmarkTrack, Faces]:
    """What the detector and the tracker keep of the clip."""
    faces = Faces()
    return follow(pictures(options), beside=faces.look), faces


def with_true_person(
    options: argparse.Namespace, truth: dict[str, Any], databank: Path, focal: float | None
) -> dict[str, float]:
    """The tracker's figures where whose face it is is known."""
    track, faces = watched(options)
    focal = focal or USUAL_FOCAL * track.size[0]
    somebody = true_person(truth, databank, track.points, focal, track.size)
    done = follow_take(track, faces, somebody, NEUTRAL)
    states = [found.state for found in done.found]
    mean, p95 = rotation_error(np.array([s.rotation for s in states]), truth["R"])
    weights = np.array([s.weights for s in states])
    ratio = surface_ratio(weights, truth, somebody.space)
    return {"rotation_mean_deg": mean, "rotation_p95_deg": p95, "surface_ratio": ratio}


def ablation(options: argparse.Namespace, truth: dict[str, Any], focal: float | None) -> None:
    """Print what each term of the tracker is worth."""
    track, faces = watched(options)
    base = ground(generic_face())
    rest = rest_of(track, base, focal=focal)
    known = calibrate(track, base, focal=focal)
    plain = from_landmarks(track, known, base, options.clip.name)
    databank = options.databank or options.truth.resolve().parent.parent / "ict"
    table = Table("without", "rotation", "p95", "dense", "amplitude", title=options.clip.name)
    left_out: dict[str, dict[str, Any]] = {
        "nothing": {},
        "texture": {"texture": 0.0},
        "meeting (pose at rest, identity)": {"meeting": False},
        "anchor": {"anchor": 1e-6},
        "predictor": {"predictor": False},
        "keyframes": {"keyframes": False},
        "motion prior": {"motion": False},
        "second start": {"retry": False},
        "prior on expressions": {"spread": 5.0},
        "silhouette": {"silhouette": 0.0},
        "nothing, but with points": {"points": 0.1},
    }
    for name, trust in left_out.items():
        somebody = generic_person(known, track.size)
        done = follow_take(track, faces, somebody, rest, Trust(**trust))
        performance = perform(track, done.found, done.met, known, plain)
        mean, p95 = rotation_error(WORLD_FROM_CAMERA @ performance.rotation, truth["R"])
        ratio, amplitude = dense_error(performance, truth, databank, options.mapping)
        table.add_row(name, *(f"{value:.2f}" for value in (mean, p95, ratio, amplitude)))
    Console().print(table)


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
    fields = targets(character, curves.names).displacements
    narrow = int(truth["narrow_count"])
    frames = truth["dense_frames"]
    true = truth["dense_q"] * truth["dense_scale"] - truth["neutral"]
    errors, moved, along, size = [], [], 0.0, 0.0
    for frame, motion in zip(frames, true[:, :narrow], strict=True):
        guess = np.tensordot(curves.weights[frame], fields[:, :narrow], axes=1)
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
