"""How well shut eyes are told from open ones, by each way of looking, over all labelled clips.

    python benchmarks/closures.py --data FOLDER [--captures landmarks tracker snakes]
        [--character man] [--takes FOLDER] [--json]

FOLDER holds video/closures.json with its clips, and truth/. Judged as benchmarks/eyes.py judges:
by the closure of the character's lids as they are drawn, an eye counts as shut from 0.7.

    f1              events of d18, d3, d6 and d9 pooled, one for each eye
    d3_left_...     least closure of the winking eye well inside its wink, greatest of the other
    clip1_...       the same of the rendered winks
    one_sided_...   runs on yaw and long1 in which one eye is shut and the other is not, where
                    labels say that no eye shuts alone; a run counts from a difference of a half

--takes keeps performances there, CLIP.CAPTURE.mien, and looks only at clips that are not yet.
"""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

import mien
from eyes import Array, event_figures, lid_closure, runs
from mien.face.character import Character
from mien.performance.performance import Performance
from report import show

EVENTS = ("d18", "d3", "d6", "d9")
TURNED = ("yaw", "long1")
WINKS = {"left": slice(8, 19), "right": slice(36, 47)}
"""Frames of d3 well inside its winks."""
APART = 0.5
"""Difference of closures from which one eye is shut alone."""
_FULL = 0.9
"""Weight of a rendered blink that is shut."""


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--captures", nargs="*", default=["landmarks", "tracker"])
    parser.add_argument("--character", default="man")
    parser.add_argument("--takes", type=Path, help="where performances are kept")
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    character = mien.load_character(options.character)
    labels = json.loads((options.data / "video" / "closures.json").read_text())
    found: dict[str, dict[str, float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        for capture in options.captures:
            takes = Takes(options.data, options.takes or Path(folder), capture)
            found[capture] = figures(takes, character, labels)
    table = Table("figure", *found, title=f"Lids of the {character.name}")
    for name in next(iter(found.values())):
        table.add_row(name, *(f"{each[name]:.3g}" for each in found.values()))
    Console().print(table)
    flat = {f"{capture}_{k}": v for capture, each in found.items() for k, v in each.items()}
    show("closures", "The same, for machines", flat, options.json)


class Takes:
    """Performances of the clips, by one capture."""

    def __init__(self, data: Path, kept: Path, capture: str) -> None:
        self._data, self._kept, self._capture = data, kept, capture
        kept.mkdir(parents=True, exist_ok=True)

    def __getitem__(self, clip: str) -> Performance:
        path = self._kept / f"{clip}.{self._capture}.mien"
        if not path.is_file():
            video = self._data / "truth" / f"{clip}.mp4"
            if not video.is_file():
                video = self._data / "video" / f"{clip}.mp4"
            mien.save_performance(mien.capture(video, method=self._capture), path)
        return mien.load_performance(path)

    def rendered_blinks(self, clip: str) -> Array:
        """(F, 2) true weights of the left and right blink."""
        truth = np.load(self._data / "truth" / f"{clip}_truth.npz")
        names = truth["expr_names"].tolist()
        return truth["expr_weights"][:, [names.index(f"eyeBlink_{side}") for side in "LR"]]


def figures(takes: Takes, character: Character, labels: Mapping[str, Any]) -> dict[str, float]:
    """All figures of one capture."""
    counts = dict.fromkeys(("found", "missed", "false"), 0.0)
    result: dict[str, float] = {}
    for clip in EVENTS:
        shown = closures(takes[clip], character)
        told = event_figures(shown, labels[clip])
        counts = {name: counts[name] + told[name] for name in counts}
        result[f"{clip}_f1"] = told["f1"]
        if clip == "d3":
            result |= winks(shown, WINKS, clip)
    result |= counts
    result["f1"] = (
        2.0 * counts["found"] / (2.0 * counts["found"] + counts["missed"] + counts["false"])
    )
    result |= rendered(closures(takes["clip1"], character), takes.rendered_blinks("clip1"))
    for clip in TURNED:
        apart = np.abs(np.diff(closures(takes[clip], character).clip(0.0, 1.0)))[:, 0] > APART
        allowed = np.zeros(len(apart), dtype=bool)
        for first, last in labels[clip]["no_one_sided"]:
            allowed[first : last + 1] = True
        result[f"one_sided_{clip}"] = float(len(runs(apart & allowed)))
        result[f"one_sided_{clip}_anywhere"] = float(len(runs(apart)))
    return result


def closures(performance: Performance, character: Character) -> Array:
    """(F, 2) as drawn."""
    return lid_closure(character, mien.animate(performance, character))


def winks(shown: Array, spans: Mapping[str, slice], clip: str) -> dict[str, float]:
    """Least closure of the eye that winks and greatest of the other."""
    found = {}
    for eye, (side, span) in enumerate(spans.items()):
        found[f"{clip}_{side}_least"] = float(shown[span, eye].min())
        found[f"{clip}_{side}_other"] = float(shown[span, 1 - eye].max())
    return found


def rendered(shown: Array, true: Array) -> dict[str, float]:
    """The same where weights are known: one blink shut and the other open."""
    found = {}
    for eye, side in enumerate(("left", "right")):
        alone = (true[:, eye] > _FULL) & (true[:, 1 - eye] < 1.0 - _FULL)
        found[f"clip1_{side}_least"] = float(shown[alone, eye].min())
        found[f"clip1_{side}_other"] = float(shown[alone, 1 - eye].max())
    return found


if __name__ == "__main__":
    main()
