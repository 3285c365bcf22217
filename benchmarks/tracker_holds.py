"""Where the tracker must hold: something before the face, motion blur, no face at all, no motion.

    python benchmarks/tracker_holds.py --clip CLIP.mp4 --truth CLIP_truth.npz [--hand HAND.mp4]
        [--still CLIP.mp4 --frame 5] [--json]

Head rotation in degrees after one constant alignment, of the clip as it is and of what is made of
it: with a thing that passes before the face, blurred along the face's own motion, and without a
face for 20 frames; and by how much the head comes late. --hand: mean confidence while a hand covers
the face and while it does not. --still: one picture repeated with noise. The landmark path stands
beside (--ways). The woman, rendered with pixel noise, blinks for 200 ms: what the filter leaves of
it on the man's lids, offline and live.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

import mien
from eyes import lid_closure
from mien.capture import CAPTURES, CaptureSettings
from mien.capture.landmarks import WORLD_FROM_CAMERA
from mien.face.animate import Poser
from mien.formats.pictures.sources import open_source
from mien.numeric.rotation import angle_between, to_vector
from mien.performance.frame import Frame
from mien.performance.performance import Performance
from mien.view.camera import Camera
from mien.view.renderer import Renderer
from report import show
from video_accuracy import occluded

Array = NDArray[np.float64]

WAYS = ("tracker", "landmarks")
GONE = slice(150, 170)
"""Frames without a face."""
RETURN = 5
"""Frames after which the face must be followed again."""
FOUND = 1.5
"""Times the usual error, and degrees on top, within which a face is followed."""
SHUTTER = 0.9
"""Of a frame's time the shutter is open in the blurred clip."""
STEPS = 9
"""Pictures that make up a blurred one."""
COVERED, FREE = slice(95, 146), slice(250, 281)
"""Frames of the clip with a hand."""
NOISE, REPEATS, SETTLED = 2.0, 100, 10
BLINK, BLINK_FRAMES, BLINK_AT = 0.2, 75, 1.55
"""Seconds a blink takes, frames of its film at 30 a second, and seconds at which it is deepest."""


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--clip", type=Path, required=True)
    parser.add_argument("--truth", type=Path, required=True)
    parser.add_argument("--hand", type=Path)
    parser.add_argument("--still", type=Path)
    parser.add_argument("--frame", type=int, default=5)
    parser.add_argument("--ways", nargs="+", default=WAYS, choices=WAYS)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    truth = dict(np.load(options.truth, allow_pickle=False))
    focal = float(truth["K"][0, 0])
    figures: dict[str, float] = {}
    for way in options.ways:
        figures |= {f"{way}_{k}": v for k, v in trials(options.clip, truth, focal, way).items()}
        if options.hand:
            figures |= {f"{way}_{k}": v for k, v in hidden(options.hand, way).items()}
        if options.still:
            figures |= {f"{way}_{k}": v for k, v in still(options, way).items()}
        figures |= {f"{way}_{k}": v for k, v in blinked(way).items()}
    show("tracker_holds", f"Holding on to {options.clip.name}", figures, options.json)


def trials(clip: Path, truth: dict[str, Any], focal: float, way: str) -> dict[str, float]:
    """Rotation error of the clip as it is, and of what is made of it."""

    def captured(frames: Iterable[Frame]) -> Performance:
        return CAPTURES[way](frames, CaptureSettings(focal=focal), clip.name)

    found = captured(open_source(clip))
    plain = errors(found, truth["R"])
    covered = errors(captured(occluded(open_source(clip))), truth["R"])
    smeared = errors(captured(blurred(open_source(clip), truth)), truth["R"])
    gap = captured(without_face(open_source(clip)))
    there = ~gap.lost
    back = np.full(len(gap.lost), np.inf)
    back[there] = errors(gap, truth["R"], there)[there]
    good = back[GONE.stop :] < FOUND * plain[GONE.stop :] + FOUND
    return {
        "rotation_deg": float(plain.mean()),
        "lag_ms": 1e3 * lag(found, truth["R"]),
        "occluded_deg": float(covered.mean()),
        "occluded_ratio": float(covered.mean() / plain.mean()),
        "blurred_deg": float(smeared.mean()),
        "blurred_ratio": float(smeared.mean() / plain.mean()),
        "gap_lost_frames": float(gap.lost.sum()),
        "gap_recovery_frames": float(np.argmax(good)),
        "gap_after_deg": float(back[GONE.stop + RETURN :].mean()),
    }


def errors(performance: Performance, true: Array, which: NDArray[np.bool_] | None = None) -> Array:
    """(F,) degrees after the constant turn that suits frames ``which`` best."""
    estimated = WORLD_FROM_CAMERA @ performance.rotation
    which = np.ones(len(true), dtype=bool) if which is None else which
    left, _, right = np.linalg.svd(np.einsum("fji,fjk->ik", true[which], estimated[which]))
    align = left @ np.diag([1.0, 1.0, np.linalg.det(left @ right)]) @ right
    return np.degrees(angle_between(true @ align, estimated))


def lag(performance: Performance, true: Array) -> float:
    """Seconds by which the head comes late: the shift of the true motion that explains most of
    where it is found, over all three axes."""
    found = WORLD_FROM_CAMERA @ performance.rotation
    way = turns(true[1:-1], true[2:]) - turns(true[1:-1], true[:-2])
    pace = way / (performance.time[2:] - performance.time[:-2])[:, None]
    off = turns(true, found)[1:-1]
    off = off - off.mean(axis=0)
    return float(-(off * pace).sum() / (pace * pace).sum())


def turns(first: Array, second: Array) -> Array:
    """(F, 3) rotation vectors, in the camera's axes, from ``first`` (F, 3, 3) to ``second``."""
    return to_vector(second @ np.swapaxes(first, 1, 2))


def blurred(frames: Iterable[Frame], truth: dict[str, Any]) -> Iterator[Frame]:
    """Every picture smeared along the way the middle of the face goes while the shutter is open,
    and turned and scaled as the face is: the mean of STEPS pictures, in linear light."""
    places = truth["fdp_px"].astype(float)
    for number, frame in enumerate(frames):
        before, after = max(number - 1, 0), min(number + 1, len(places) - 1)
        way = (places[after] - places[before]) / max(after - before, 1)
        seen = truth["fdp_visible"][number]
        turn, _ = cv2.estimateAffinePartial2D(
            places[number][seen], (places[number] + SHUTTER * way)[seen]
        )
        linear = (frame.image.astype(np.float32) / 255.0) ** 2.2
        mean = np.zeros_like(linear)
        for share in np.linspace(-0.5, 0.5, STEPS):
            part = np.eye(2, 3) + share * (turn - np.eye(2, 3))
            size = (linear.shape[1], linear.shape[0])
            mean += cv2.warpAffine(linear, part, size, borderMode=cv2.BORDER_REPLICATE)
        image = np.clip(np.rint(255.0 * (mean / STEPS) ** (1 / 2.2)), 0, 255).astype(np.uint8)
        yield Frame(image, frame.time)


def without_face(frames: Iterable[Frame]) -> Iterator[Frame]:
    """The clip with an empty wall for GONE."""
    for number, frame in enumerate(frames):
        gone = GONE.start <= number < GONE.stop
        yield Frame(np.full_like(frame.image, 128), frame.time) if gone else frame


def hidden(hand: Path, way: str) -> dict[str, float]:
    """Mean confidence with a hand over the face and without."""
    confidence = CAPTURES[way](open_source(hand), CaptureSettings(), hand.name).confidence
    covered, free = confidence[COVERED].mean(), confidence[FREE].mean()
    return {"covered": covered, "free": free, "covered_ratio": covered / free}


def blinking() -> Iterator[Frame]:
    """The woman blinks once: raised cosine, pixel noise."""
    woman = mien.load_character("woman")
    poser, renderer = Poser(woman.face, woman.keys), Renderer(woman.face)
    lids = [woman.keys.names.index(f"blink_{side}") for side in ("left", "right")]
    random = np.random.default_rng(2)
    for number in range(BLINK_FRAMES):
        weights = np.zeros(len(woman.keys.names))
        phase = np.clip((number / 30.0 - BLINK_AT) / BLINK, -0.5, 0.5)
        weights[lids] = 0.5 + 0.5 * np.cos(2.0 * np.pi * phase)
        picture = renderer.render(poser.pose(weights), Camera(size=(480, 480)))
        noisy = picture + random.normal(0.0, NOISE, picture.shape)
        yield Frame(np.clip(np.rint(noisy), 0, 255).astype(np.uint8), number / 30.0)


def blinked(way: str) -> dict[str, float]:
    """Share of a blink's depth that the filter leaves, the eye that loses most."""
    found = CAPTURES[way](blinking(), CaptureSettings(), "blink")
    man = mien.load_character("man")

    def deepest(**options: bool) -> Array:
        return lid_closure(man, mien.animate(found, man, **options)).max(axis=0)

    raw = deepest(smooth=False)
    return {
        "blink_depth": float(raw.min()),
        "blink_kept": float((deepest() / raw).min()),
        "blink_kept_live": float((deepest(causal=True) / raw).min()),
    }


def still(options: argparse.Namespace, way: str) -> dict[str, float]:
    """Shake of head and features, in degrees and per cent of the outer-eye distance."""
    picture = next(f.image for i, f in enumerate(open_source(options.still)) if i == options.frame)
    random = np.random.default_rng(1)

    def repeats() -> Iterator[Frame]:
        for i in range(REPEATS):
            noisy = picture + random.normal(0.0, NOISE, picture.shape)
            yield Frame(np.clip(np.rint(noisy), 0, 255).astype(np.uint8), i / 30.0)

    found = CAPTURES[way](repeats(), CaptureSettings(), options.still.name)
    turn = errors(found, np.broadcast_to(np.eye(3), found.rotation.shape))
    away = found.motion - found.motion.mean(0)
    corner = {fdp: found.neutral[found.points.index(fdp)] for fdp in ("3.7", "3.12")}
    eyes = np.linalg.norm(corner["3.7"] - corner["3.12"])
    return {
        "still_deg": float(np.sqrt((turn**2).mean())),
        "still_settled_deg": float(np.sqrt((turn[SETTLED:] ** 2).mean())),
        "still_features_pct": 100.0 * float(np.sqrt((away**2).sum(-1).mean()) / eyes),
        "still_features_settled_pct": 100.0
        * float(np.sqrt((away[SETTLED:] ** 2).sum(-1).mean()) / eyes),
    }


if __name__ == "__main__":
    main()
