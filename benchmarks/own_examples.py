"""What it is worth to know a performer's own faces, and a performer's own range.

    python benchmarks/own_examples.py --data FOLDER [--json]

FOLDER is that of the ICT face. An ICT person has habits: each of five faces is done by half as much
again and with two shapes that nobody else would use for it. The five are held once, and named; the
rest of the take mixes them at all levels. Error is the skin's of the woman who is driven, against
her own faces at the same levels, relative to kind (b): the generic face's examples of those names.

Retargeting: the same take with the motion of one region scaled by 0.5 or 0.7, each with the range
fitted to itself; how much the mean weights of that region's pieces differ from the unscaled take's.
"""

from __future__ import annotations

import argparse
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from heads import Ict
from mien.capture.landmarks import POINTS, SIGMA
from mien.face.character import Character
from mien.face.face import Face
from mien.face.library import load_character
from mien.face.pieces import REGIONS, region_masks, split
from mien.face.targets import targets
from mien.mapping import MAPPERS, Settings
from mien.mapping.own import own_examples
from mien.mapping.ranges import measure_ranges
from mien.performance.acted import acted
from mien.performance.performance import Performance
from report import show

Array = NDArray[np.float64]

FACES = {"smile": "smile", "surprise": "surprise", "anger": "anger", "sad": "sad", "pucker": "kiss"}
"""The woman's key models, and the faces of the ICT databank that mean the same."""
EXCESS = 1.5
MARKERS = 0.3
"""mm, standard error of markers: the landmarks of a video are no surer of lids than they move."""
FRAMES = 300
RATE = 30.0


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    ict = Ict(options.data)
    faces = json.loads((options.data / "databank25.json").read_text())["faces"]
    woman = load_character("woman")
    performance, levels, names = take(ict, faces, "person1")
    truth = skin_motion(woman, levels, names)
    own = own_examples(performance, [(row / RATE, {name: 1.0}) for row, name in enumerate(names)])
    ways = {
        "generic": Settings(examples="generic"),
        "character": Settings(),
        "own": Settings(own=own),
    }
    rest = slice(len(names), None)
    errors = {
        way: error(woman, performance, settings, truth, rest) for way, settings in ways.items()
    }
    figures = {f"{way}_error": value for way, value in errors.items()}
    figures["error_ratio"] = errors["own"] / errors["generic"]
    figures["at_examples"] = at_examples(woman, performance, ways["own"], names)
    figures |= retargeting(woman, performance)
    show("own_examples", "Own examples and own range", figures, options.json)


def take(
    ict: Ict, faces: dict[str, dict[str, dict[str, float]]], person: str
) -> tuple[Performance, Array, list[str]]:
    """The performance, its levels (F, 5) and the five names; each is held in the first frames."""
    rng = np.random.default_rng(11)
    character = ict.character(person)
    names = list(FACES)
    mixes = [faces[FACES[name]]["weights"] for name in names]
    poses = np.zeros((len(names), len(ict.names)))
    for pose, mix in zip(poses, mixes, strict=True):
        for shape, weight in mix.items():
            pose[ict.names.index(shape)] = EXCESS * weight
        habits = [i for i, n in enumerate(ict.names) if not n.startswith(("eye", "jaw", "mouthC"))]
        pose[rng.choice(habits, 2, replace=False)] += 0.4
    levels = np.zeros((FRAMES, len(names)))
    levels[: len(names)] = np.eye(len(names))
    for frame in levels[len(names) :]:
        chosen = rng.choice(len(names), 2, replace=False)
        frame[chosen] = rng.uniform(0.1, 0.9) * np.array([1.0, rng.uniform(0.0, 0.5)])
    face = character.face
    ids = tuple(fdp for fdp in POINTS if fdp in face.points.ids)
    fields = face.points.at(character.keys.displacements.astype(float))
    motion = np.tensordot(levels @ poses, fields[:, face.points.index(ids)], axes=1)
    neutral = face.points.at(face.vertices)[face.points.index(ids)]
    sigma = np.array([SIGMA[POINTS.index(fdp)] for fdp in ids])
    return acted(ids, neutral, motion, sigma=sigma, rate=RATE), levels, names


def skin_motion(character: Character, levels: Array, names: list[str]) -> Array:
    """(F, V, 3) of the character's own faces at ``levels``."""
    skin = character.face.part("skin")
    fields = np.stack([character.keys[name][skin.first : skin.last] for name in names])
    return np.tensordot(levels, fields.astype(float), axes=1)


def error(
    character: Character, performance: Performance, settings: Settings, truth: Array, rest: slice
) -> float:
    """Mean error of the skin over its mean motion."""
    curves = MAPPERS["cardinal"](character, performance, settings)(performance)
    skin = character.face.part("skin")
    fields = targets(character, curves.names).displacements[:, skin.first : skin.last]
    made = np.tensordot(curves.weights, fields.astype(float), axes=1)[rest]
    moved = np.linalg.norm(truth[rest], axis=-1).mean()
    return float(np.linalg.norm(made - truth[rest], axis=-1).mean() / moved)


def at_examples(
    character: Character, performance: Performance, settings: Settings, names: list[str]
) -> float:
    """The largest error of a weight in the held poses."""
    mapper = MAPPERS["cardinal"](character, performance, settings)
    pieces = split(character)
    weights = mapper(performance).weights[: len(names)]
    wanted = np.stack(
        [(pieces.key == character.keys.names.index(name)).astype(float) for name in names]
    )
    return float(np.abs(weights - wanted).max())


def retargeting(character: Character, performance: Performance) -> dict[str, float]:
    """The largest relative change of a region's mean weight, over regions and scales."""
    performance = replace(performance, sigma=np.full_like(performance.sigma, MARKERS))
    worst, unfitted = 0.0, 0.0
    before = mean_weights(character, performance, fitted=True)
    plain = mean_weights(character, performance, fitted=False)
    for region in range(len(REGIONS)):
        for scale in (0.5, 0.7):
            smaller = scaled(character.face, performance, region, scale)
            after = mean_weights(character, smaller, fitted=True)
            worst = max(worst, abs(after[region] / before[region] - 1.0))
            bare = mean_weights(character, smaller, fitted=False)
            unfitted = max(unfitted, abs(bare[region] / plain[region] - 1.0))
    return {"retargeted_change": worst, "unfitted_change": unfitted}


def mean_weights(character: Character, performance: Performance, fitted: bool) -> Array:
    """(3,) mean weight of the pieces of each region."""
    settings = Settings(ranges=measure_ranges(performance) if fitted else None)
    weights = MAPPERS["cardinal"](character, performance, settings)(performance).weights
    pieces = split(character)
    return np.array([weights[:, pieces.region == r].mean() for r in range(len(REGIONS))])


def scaled(face: Face, performance: Performance, region: int, scale: float) -> Performance:
    """The performance with the motion of one region scaled."""
    rows = face.points.index(performance.points)
    share = region_masks(face, face.points.at(face.vertices)[rows])[region]
    factor = 1.0 + (scale - 1.0) * share
    return replace(performance, motion=performance.motion * factor[:, None])


if __name__ == "__main__":
    main()
