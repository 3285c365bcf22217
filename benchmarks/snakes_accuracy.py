"""How near the curves lie to the features of a face.

    python benchmarks/snakes_accuracy.py --video take.mp4 [--performer FILE] [--light] [--json]
    ... --frames 120    only so many frames, from the first on
    python benchmarks/snakes_accuracy.py --clip CLIP.mp4 --truth CLIP_truth.npz [--json]
    python benchmarks/snakes_accuracy.py --photos FOLDER [--json]

Mean distance between curve and contour, both ways, in percent of the distance of the pupils, on
frames with a head yaw below 15 degrees. Contours are the landmark networks' on the same frames;
the projected 68 points of a rendered truth (brows: one line); or points placed by hand
(points.json in the folder), each photo from nothing, medians. Lost: beyond 12 (brows, lips) or 8
(lids); of lips, the share marked as lost of those beyond 12, and of those within 6. --light repeats
the take under synthetic light that sets in after the first frame; unscaled, all frames are judged
by the skin of the first.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.detector import Detector
from mien.capture.known import curve_calibration
from mien.capture.snakes.colour.palette import trained
from mien.capture.snakes.colour.training import least_squares
from mien.capture.snakes.curves.features import LASTING, NAMES, ROW
from mien.capture.snakes.curves.fields import Weigh, usual_weights
from mien.capture.snakes.curves.lens import lower_curve, upper_curve
from mien.capture.snakes.seen import Seen
from mien.capture.snakes.stepper import SnakeCapture
from mien.formats.performer_file import read_performer
from mien.formats.pictures.sources import open_source
from mien.performance.frame import Frame
from mien.vocabulary.topology import BROW_LOWER, BROW_UPPER, LID_LOOPS, LIP_LOOPS, mirrored
from report import show

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]
Contours = Mapping[str, tuple[Array, ...]]

MOST_YAW = 15.0
LOST = {"brows": 12.0, "lids": 8.0, "outer_lips": 12.0, "inner_lips": 12.0}
NEAR = 6.0
"""Percent within which lips are plainly found."""
PARTS = {
    "brows": ("brow_right", "brow_left"),
    "lids": ("eye_right", "eye_left"),
    "outer_lips": ("lips",),
    "inner_lips": ("mouth",),
}
LIGHTS: dict[str, tuple[tuple[float, float, float], float]] = {
    "as it is": ((1.0, 1.0, 1.0), 0.0),
    "dim": ((0.5, 0.5, 0.5), 0.0),
    "bright": ((1.6, 1.6, 1.6), 0.0),
    "warm": ((1.2, 1.0, 0.75), 0.0),
    "cool": ((0.8, 1.0, 1.25), 0.0),
    "from one side": ((1.0, 1.0, 1.0), 0.5),
}
"""Gain of each channel, and how much darker the picture's right is than its left."""


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--video", type=Path)
    parser.add_argument("--clip", type=Path)
    parser.add_argument("--truth", type=Path)
    parser.add_argument("--photos", type=Path)
    parser.add_argument("--performer", type=Path, help="what mien calibrate learnt")
    parser.add_argument("--frames", type=int, help="judge only the first so many")
    parser.add_argument("--light", action="store_true", help="also under synthetic light")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    if options.photos:
        figures, name = photo_figures(options.photos), options.photos.name
    elif options.clip:
        truth = dict(np.load(options.truth, allow_pickle=False))
        contours = [true_contours(truth, frame) for frame in range(len(truth["R"]))]
        yaw = np.abs(truth["yaw_pitch_roll_deg"][:, 0])
        kept = [c if y < MOST_YAW else None for c, y in zip(contours, yaw, strict=True)]
        name, take = options.clip.name, open_source(options.clip)
        figures = take_figures(take, kept[: options.frames], stepper_of(options))
    else:
        name, take = options.video.name, open_source(options.video)
        kept = network_contours(islice(take, options.frames))
        figures = take_figures(take, kept, stepper_of(options))
        if options.light:
            figures |= light_figures(options, kept)
    show("snakes_accuracy", f"Curves on {name}", figures, options.json)


def stepper_of(options: argparse.Namespace) -> Callable[[], SnakeCapture]:
    """A fresh capture as the options have it."""
    if options.performer is None:
        return SnakeCapture
    _, look, networks = curve_calibration(read_performer(options.performer).curves)
    return lambda: SnakeCapture(look, trained(networks))


def take_figures(
    frames: Iterable[Frame],
    contours: list[Contours | None],
    make: Callable[[], SnakeCapture],
    light: str = "as it is",
) -> dict[str, float]:
    """Errors over a take against the contours of each frame (None: does not count)."""
    stepper = make()
    errors: list[list[float]] = []
    lips_lost: list[bool] = []
    recovered = flagged = count = 0
    for wanted, frame in zip(contours, frames, strict=False):
        seen = stepper.step(lit(frame.image, light if count else "as it is"))
        count += 1
        recovered += seen is None or (seen.recovered and count > 1)
        flagged += seen is None or bool(seen.lost[LASTING].any())
        if wanted is not None and seen is not None:
            errors.append([part_error(seen, wanted, part) for part in PARTS])
            lips_lost.append(bool(seen.lost[ROW["lips"]]))
    table = np.array(errors)
    return {
        **{f"{part}_pct": float(np.nanmean(table[:, i])) for i, part in enumerate(PARTS)},
        **{f"{part}_lost": lost_share(table, i, part) for i, part in enumerate(PARTS)},
        "recovered_fraction": recovered / count,
        "lost_fraction": float(np.mean([lost_share(table, i, p) for i, p in enumerate(PARTS)])),
        "flagged_fraction": flagged / count,
        **lips_marked(table[:, list(PARTS).index("outer_lips")], np.array(lips_lost)),
        "frames_judged": float(len(table)),
    }


def lips_marked(errors: Array, lost: NDArray[np.bool_]) -> dict[str, float]:
    """Share of frames marked as lost of those whose lips are nowhere near, and of those near."""
    off, near = errors > LOST["outer_lips"], errors < NEAR
    return {
        "lips_off": float(off.mean()),
        "lips_off_marked": float(lost[off].mean()) if off.any() else 1.0,
        "lips_near_marked": float(lost[near].mean()) if near.any() else 0.0,
    }


def photo_figures(folder: Path) -> dict[str, float]:
    """Medians over photos, each looked at on its own."""
    known = json.loads((folder / "points.json").read_text())
    errors = []
    for name, facts in sorted(known["photos"].items()):
        image = np.ascontiguousarray(cv2.imread(str(folder / name))[:, :, ::-1])
        seen = SnakeCapture().step(image)
        wanted = hand_contours(known["contours"], np.array(facts["points"], dtype=float) + 0.5)
        errors.append(
            [np.inf] * len(PARTS)
            if seen is None
            else [part_error(seen, wanted, part) for part in PARTS]
        )
    table = np.array(errors)
    gone = np.array([table[:, i] > LOST[part] for i, part in enumerate(PARTS)])
    return {
        **{f"{part}_pct": float(np.median(table[:, i])) for i, part in enumerate(PARTS)},
        **{f"{part}_lost": float(gone[i].sum()) for i, part in enumerate(PARTS)},
        "recovered_fraction": 0.0,
        "lost_fraction": float(gone.mean()),
        "starts_lost": float(gone.any(axis=0).sum()),
    }


def light_figures(options: argparse.Namespace, kept: list[Contours | None]) -> dict[str, float]:
    """How much worse each kind of weights gets under each light, worst light over all."""
    figures: dict[str, float] = {}
    ways: dict[str, Weigh] = {"fixed": usual_weights, "own": least_squares}
    if options.performer is not None:
        networks = curve_calibration(read_performer(options.performer).curves)[2]
        ways["network"] = trained(networks)
    for name, weigh in ways.items():
        for scaled in (True, False):
            plain: dict[str, float] = {}
            make = partial(SnakeCapture, None, weigh, scaled)
            way = f"{name}_{'scaled' if scaled else 'unscaled'}"
            for light in LIGHTS:
                found = take_figures(open_source(options.video), kept, make, light)
                plain = plain or found
                for part in PARTS:
                    worse = found[f"{part}_pct"] - plain[f"{part}_pct"]
                    key = f"{way}_{part}_worse"
                    figures[key] = max(figures.get(key, 0.0), worse)
    return figures


def lit(image: Picture, light: str) -> Picture:
    """``image`` under one of LIGHTS."""
    gain, side = LIGHTS[light]
    if light == "as it is":
        return image
    across = 1.0 - side * np.linspace(0.0, 1.0, image.shape[1])[None, :, None]
    return np.clip(image * np.array(gain) * across, 0, 255).astype(np.uint8)


def lost_share(table: Array, column: int, part: str) -> float:
    """Share of frames in which a part is nowhere near."""
    return float((table[:, column] > LOST[part]).mean())


def part_error(seen: Seen, wanted: Contours, part: str) -> float:
    """Percent of the pupils' distance, the mean over a part's edges."""
    apart = float(np.linalg.norm(wanted["pupils"][0][1] - wanted["pupils"][0][0]))
    errors = []
    for name in PARTS[part]:
        lens = seen.lenses[(*NAMES, "mouth").index(name)]
        edges = [seen.placement.to_frame(curve(lens, 41)) for curve in (upper_curve, lower_curve)]
        if len(wanted[name]) == 1:
            edges = [0.5 * (edges[0] + edges[1])]
        errors += [both_ways(a, b) for a, b in zip(edges, wanted[name], strict=True)]
    return 100.0 * float(np.mean(errors)) / apart


def both_ways(one: Array, two: Array) -> float:
    """Mean distance between two polylines, the mean of both ways."""
    return 0.5 * (distance(dense(one), two) + distance(dense(two), one))


def dense(line: Array, count: int = 41) -> Array:
    """(count, 2) places evenly along a polyline."""
    length = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(line, axis=0), axis=1))])
    at = np.linspace(0.0, length[-1], count)
    return np.stack([np.interp(at, length, line[:, axis]) for axis in (0, 1)], axis=1)


def distance(places: Array, line: Array) -> float:
    """Mean distance of places (N, 2) to a polyline (M, 2)."""
    first, step = line[:-1], np.diff(line, axis=0)
    size = np.maximum((step**2).sum(1), 1e-9)
    share = np.clip(((places[:, None] - first) * step).sum(-1) / size, 0.0, 1.0)
    near = first + share[..., None] * step
    return float(np.linalg.norm(places[:, None] - near, axis=-1).min(1).mean())


def network_contours(frames: Iterable[Frame]) -> list[Contours | None]:
    """The landmark networks' contours of every frame; None where turned or not seen."""
    with Detector() as detector:
        found = [detector.landmarks(frame.image) for frame in frames]
    return [None if p is None or turned(p) else mesh_contours(p.astype(float)) for p in found]


def turned(points: NDArray[np.float32]) -> bool:
    """Whether the head is turned too far to judge: yaw of the eyes' outer corners in depth."""
    across = points[263] - points[33]
    return bool(abs(np.degrees(np.arctan2(across[2], np.hypot(*across[:2])))) > MOST_YAW)


def mesh_contours(points: Array) -> Contours:
    """From the landmarks of one frame, every edge from the picture's left to its right."""
    lid, lip, inner = LID_LOOPS[0], LIP_LOOPS[3], LIP_LOOPS[0]
    edges = {
        "brow_left": (BROW_UPPER, BROW_LOWER),
        "eye_left": (lid[:9], np.r_[lid[8:], lid[:1]]),
        "lips": (lip[:11], np.r_[lip[10:], lip[:1]]),
        "mouth": (inner[:11], np.r_[inner[10:], inner[:1]]),
    }
    for part in ("brow", "eye"):
        edges[f"{part}_right"] = tuple(mirrored(edge) for edge in edges[f"{part}_left"])
    lines = {name: tuple(points[edge, :2] for edge in pair) for name, pair in edges.items()}
    return lines | {"pupils": (points[[468, 473], :2],)}


def hand_contours(table: Mapping[str, Any], points: Array) -> Contours:
    """From points placed by hand."""

    def edges(upper: str, lower: str) -> tuple[Array, Array]:
        return points[table[upper]], points[table[lower]]

    lines = {
        f"{part}_{side}": edges(f"{word}_upper_{side}", f"{word}_lower_{side}")
        for part, word in (("brow", "brow"), ("eye", "lid"))
        for side in ("right", "left")
    }
    return lines | {
        "lips": edges("lip_upper_outer", "lip_lower_outer"),
        "mouth": edges("lip_upper_inner", "lip_lower_inner"),
        "pupils": (points[[0, 1]],),
    }


def true_contours(truth: Mapping[str, Any], frame: int) -> Contours:
    """From the 68 points of a rendered truth; its brows are one line each."""
    place = truth["pie68_head"][frame] @ truth["R"][frame].T + truth["t"][frame]
    picture = place @ truth["K"].T
    points = picture[:, :2] / picture[:, 2:]
    eyes = truth["eye_centre"] @ truth["R"][frame].T + truth["t"][frame]
    pupils = (eyes @ truth["K"].T)[:, :2] / eyes[:, 2:]
    return {
        "brow_right": (points[17:22],),
        "brow_left": (points[22:27],),
        "eye_right": (points[36:40], points[[36, 41, 40, 39]]),
        "eye_left": (points[42:46], points[[42, 47, 46, 45]]),
        "lips": (points[48:55], points[[48, 59, 58, 57, 56, 55, 54]]),
        "mouth": (points[60:65], points[[60, 67, 66, 65, 64]]),
        "pupils": (pupils[::-1],),
    }


if __name__ == "__main__":
    main()
