"""How truly a character's lids follow a performer's.

    python benchmarks/eyes.py --video d3.mp4 [--still clip.mp4 --frame 5] [--json]

Judged on the man's lids as they are drawn, not on weights: closure is one minus lid opening over
the opening at neutral. Labels come from --labels (closures.json beside the video): closed spans
per eye, and spans that do not count. --still repeats one picture 100 times with pixel noise and
measures how much the skin shakes.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import mien
from mien.capture import CAPTURES, CaptureSettings
from mien.face.animate import Poser
from mien.face.character import Character
from mien.face.pieces import split
from mien.formats.pictures.sources import open_source
from mien.performance.curves import Curves
from mien.performance.frame import Frame
from report import show

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]

EYES = ("left", "right")
SHUT = 0.7
"""Closure from which an eye counts as shut."""
NEAR = 3
"""Runs with as many frames between them are one; detections may be this early or late."""
NOISE, REPEATS = 2.0, 100


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--video", type=Path, required=True)
    parser.add_argument("--labels", type=Path, help="closures.json (default: beside the video)")
    parser.add_argument("--still", type=Path, help="a video with a resting face")
    parser.add_argument("--frame", type=int, default=5, help="which of its frames to repeat")
    parser.add_argument("--character", default="man")
    parser.add_argument("--capture", default="landmarks")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()

    character = mien.load_character(options.character)
    performance = mien.capture(options.video, method=options.capture)
    raw = lid_closure(character, mien.animate(performance, character, smooth=False))
    shown = lid_closure(character, mien.animate(performance, character))
    figures: dict[str, float] = {
        "one_sided_frames": float((np.abs(np.diff(np.clip(shown, 0, 1)))[:, 0] > 0.5).sum()),
        "both_shut_runs": float(len(runs((shown > SHUT).all(1)))),
    }
    path = options.labels or options.video.with_name("closures.json")
    labels = json.loads(path.read_text()).get(options.video.stem, {}) if path.is_file() else {}
    if labels.get("closures"):
        figures |= wink_figures(shown, labels) | event_figures(shown, labels)
        figures["blink_kept"] = blink_kept(raw, shown, labels)
    if options.still:
        figures |= stillness(character, options.still, options.frame, options.capture)
    show("eyes", f"The {character.name}'s eyes on {options.video.name}", figures, options.json)


def lid_closure(character: Character, curves: Curves) -> Array:
    """(F, 2) closure of the character's left and right eye as drawn."""
    points = character.face.points
    rows = [points.index(pair) for pair in (("3.1", "3.3"), ("3.2", "3.4"))]

    def opening(places: Array) -> Array:
        return np.array([places[u, 1] - places[d, 1] for u, d in rows])

    keys = split(character)
    moved = points.at(keys.displacements.astype(float))
    rest = points.at(character.face.vertices)
    # Curves may drive keys outright that have no pieces, such as the tongue.
    columns = [curves.names.index(name) for name in keys.names]
    places = rest + np.tensordot(curves.weights[:, columns], moved, axes=1)
    return np.array([1.0 - opening(place) / opening(rest) for place in places])


def runs(mask: Bools) -> list[tuple[int, int]]:
    """(first, last) of every run of True, those with at most NEAR frames between them joined."""
    frames = np.flatnonzero(mask)
    if len(frames) == 0:
        return []
    breaks = np.flatnonzero(np.diff(frames) > NEAR + 1) + 1
    return [(int(run[0]), int(run[-1])) for run in np.split(frames, breaks)]


def labelled(labels: dict[str, Any], eye: str, frames: int) -> Bools:
    """(F,) True where ``eye`` is labelled closed."""
    mask = np.zeros(frames, dtype=bool)
    for closure in labels["closures"]:
        if closure["eye"] in (eye, "both"):
            mask[closure["first"] : closure["last"] + 1] = True
    return mask


def wink_figures(shown: Array, labels: dict[str, Any]) -> dict[str, float]:
    """Least closure of a winking eye and greatest of the other, well inside the winks."""
    figures: dict[str, float] = {}
    for closure in labels["closures"]:
        if closure["kind"] != "wink":
            continue
        eye = EYES.index(closure["eye"])
        other = np.flatnonzero(labelled(labels, EYES[1 - eye], len(shown)))
        during = other[(other >= closure["first"]) & (other <= closure["last"])]
        last = int(during[0]) if len(during) else closure["last"]
        inside = slice(closure["first"] + 3, last - 1)
        name = f"wink_{EYES[eye]}"
        figures[f"{name}_closed_min"] = float(shown[inside, eye].min())
        figures[f"{name}_open_max"] = float(shown[inside, 1 - eye].max())
    if figures:
        closed = [value for key, value in figures.items() if key.endswith("closed_min")]
        opened = [value for key, value in figures.items() if key.endswith("open_max")]
        figures |= {"wink_closed_min": min(closed), "wink_open_max": max(opened)}
    return figures


def event_figures(shown: Array, labels: dict[str, Any]) -> dict[str, float]:
    """Closures found, missed and false over both eyes, and their F1."""
    found = false = total = 0
    for eye, name in enumerate(EYES):
        closed = labelled(labels, name, len(shown))
        ignored = np.zeros(len(shown), dtype=bool)
        spans = [span[:2] for span in labels.get("dont_care", [])]
        spans += [span[1:3] for span in labels.get("dont_care_eye", []) if span[0] == name]
        for first, last in spans:
            ignored[first : last + 1] = True
        detected = runs((shown[:, eye] > SHUT) & (~ignored | closed))
        used: set[int] = set()
        for first, last in runs(closed):
            total += 1
            near = [
                i
                for i, (a, b) in enumerate(detected)
                if a <= last + NEAR and b >= first - NEAR and i not in used
            ]
            found += bool(near)
            # Several runs on one closure count once; one run serves one closure only.
            used.update(
                near if len(near) == 1 else [i for i in near if detected[i][1] <= last + NEAR]
            )
            used.update(near[:1])
        false += len(detected) - len(used)
    precision, recall = found / max(found + false, 1), found / max(total, 1)
    f1 = 2 * precision * recall / max(precision + recall, 1e-9)
    return {"found": found, "missed": total - found, "false": false, "f1": f1}


def blink_kept(raw: Array, shown: Array, labels: dict[str, Any]) -> float:
    """Least share of a labelled blink's peak that the filter leaves."""
    kept = [1.0]
    for closure in labels["closures"]:
        if closure["kind"] == "blink":
            eyes = [0, 1] if closure["eye"] == "both" else [EYES.index(closure["eye"])]
            span = slice(max(closure["first"] - NEAR, 0), closure["last"] + NEAR + 1)
            kept += [float(shown[span, eye].max() / raw[span, eye].max()) for eye in eyes]
    return min(kept)


def stillness(character: Character, video: Path, number: int, capture: str) -> dict[str, float]:
    """Root mean square shake of the skin, mm, of one picture repeated with noise."""
    picture = next(f.image for i, f in enumerate(open_source(video)) if i == number)

    def repeats() -> Iterator[Frame]:
        random = np.random.default_rng(1)
        for i in range(REPEATS):
            noisy = picture + random.normal(0.0, NOISE, picture.shape)
            yield Frame(np.clip(np.rint(noisy), 0, 255).astype(np.uint8), i / 30.0)

    performance = CAPTURES[capture](repeats(), CaptureSettings(), video.name)
    pieces = split(character)
    poser = Poser(character.face, pieces)
    skin = character.face.part("skin")

    def shake(curves: Curves) -> float:
        places = np.array([poser.morph(w)[skin.first : skin.last] for w in curves.weights])
        return float(np.sqrt(((places - places.mean(0)) ** 2).sum(-1).mean()))

    return {
        "still_mm": shake(mien.animate(performance, character, smooth=False)),
        "still_filtered_mm": shake(mien.animate(performance, character)),
    }


if __name__ == "__main__":
    main()
