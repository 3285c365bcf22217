"""Does blending wire by wire serve half faces better than blending whole ones?

    python benchmarks/local_mapping.py --data FOLDER [--json]

FOLDER is that of the ICT face. The character has ICT's shapes joined into two-sided key models; the
performer, of the same face, mixes ICT's one-sided shapes: half a face at a time, and both halves
each by itself. Error is the skin's, over doing nothing; the ratio is that of wires over one weight
for each whole key model (global), beside the default pieces of region and side.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from heads import Ict
from mien.capture.landmarks import POINTS, SIGMA
from mien.face.character import Character, KeyModels
from mien.face.targets import targets
from mien.mapping import MAPPERS, Settings
from mien.performance.acted import acted
from mien.performance.performance import Performance
from report import show

Array = NDArray[np.float64]

FRAMES = 150


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    person = Ict(options.data).character()
    character = two_sided(person)
    takes = {"half": half_faces(person), "asymmetric": asymmetric(person)}
    figures: dict[str, float] = {}
    for name, weights in takes.items():
        performance, truth = perform(person, weights)
        for way, driven, mapping in (
            ("global", replace(character, whole=True), "cardinal"),
            ("pieces", character, "cardinal"),
            ("wires", character, "wires"),
        ):
            figures[f"{name}_{way}"] = error(driven, mapping, performance, truth)
        figures[f"{name}_ratio"] = figures[f"{name}_wires"] / figures[f"{name}_global"]
    figures["error_ratio"] = max(figures[f"{name}_ratio"] for name in takes)
    show("local_mapping", "Wires against whole key models", figures, options.json)


def two_sided(person: Character) -> Character:
    """A character whose key models are pairs of one-sided shapes, and those that have no sides."""
    joined: dict[str, Array] = {}
    for name, field in zip(person.keys.names, person.keys.displacements, strict=True):
        if not name.startswith(("eyeLook", "cheekRaiser")):
            stem = name.removesuffix("_L").removesuffix("_R")
            joined[stem] = joined.get(stem, 0.0) + field.astype(float)
    keys = KeyModels(tuple(joined), np.stack(list(joined.values())).astype(np.float32))
    blinks = frozenset({"eyeBlink"})
    return Character("ict", person.face, keys, keys.names, blinks=blinks)


def half_faces(person: Character) -> Array:
    """(F, 55) three shapes of one side at a time."""
    return _draw(person, sides=1)


def asymmetric(person: Character) -> Array:
    """(F, 55) three shapes of each side, at levels of their own."""
    return _draw(person, sides=2)


def _draw(person: Character, sides: int) -> Array:
    rng = np.random.default_rng(7)
    names = person.keys.names
    weights = np.zeros((FRAMES, len(names)))
    for frame in weights:
        for side in rng.permutation(["_L", "_R"])[:sides]:
            rows = [
                i for i, n in enumerate(names) if n.endswith(side) and not n.startswith("eyeLook")
            ]
            frame[rng.choice(rows, 3, replace=False)] = rng.uniform(0.3, 1.0, 3)
    return weights


def perform(person: Character, weights: Array) -> tuple[Performance, Array]:
    """The performance at the feature points, and the skin's motion (F, V, 3)."""
    face = person.face
    ids = tuple(fdp for fdp in POINTS if fdp in face.points.ids)
    sigma = np.array([SIGMA[POINTS.index(fdp)] for fdp in ids])
    fields = person.keys.displacements.astype(float)
    at = face.points.at(fields)[:, face.points.index(ids)]
    neutral = face.points.at(face.vertices)[face.points.index(ids)]
    skin = face.part("skin")
    truth = np.tensordot(weights, fields[:, skin.first : skin.last], axes=1)
    return acted(ids, neutral, np.tensordot(weights, at, axes=1), sigma=sigma), truth


def error(character: Character, mapping: str, performance: Performance, truth: Array) -> float:
    """Mean error of the skin over mean motion."""
    curves = MAPPERS[mapping](character, performance, Settings())(performance)
    skin = character.face.part("skin")
    fields = targets(character, curves.names).displacements[:, skin.first : skin.last]
    made = np.tensordot(curves.weights, fields, axes=1)
    apart = np.linalg.norm(made - truth, axis=-1).mean()
    return float(apart / np.linalg.norm(truth, axis=-1).mean())


if __name__ == "__main__":
    main()
