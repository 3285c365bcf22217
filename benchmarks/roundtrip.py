"""How truly weights come back: a recorded take drives a head, whose feature points drive it again.

    python benchmarks/roundtrip.py --head facecap_plain.glb --take arkit_take.npz [--json]

The head is imported as any other, its feature points found by looking. They are sampled from its
surface as the take's weights animate it and mapped again, without names: the mean absolute error
over the channels that exceed 0.05 anywhere. Beside it what doing nothing and holding the first
frame would cost, and the error when the weights pass through under their own vocabulary.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np

import mien
from mien.face.character import Character
from mien.performance.acted import acted
from mien.performance.performance import Array, Performance
from mien.rig.importer import import_character
from mien.rig.spoken import plain
from mien.vocabulary.arkit import names
from report import show

ACTIVE = 0.05
"""A channel that never exceeds this is left out."""
SIGMA = 0.1
"""mm; the points are exact but for the mesh they lie on."""


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--head", type=Path, required=True)
    parser.add_argument("--take", type=Path, required=True, help=".npz with names and weights")
    parser.add_argument("--units", default="face")
    parser.add_argument("--points", type=Path)
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()

    head = import_character(options.head, points=options.points, units=options.units).character
    with np.load(options.take) as take:
        told = [plain(str(name)) for name in take["names"]]
        weights = take["weights"].astype(float)
    own = {plain(name): i for i, name in enumerate(head.keys.names)}
    common = [name for name in told if name in own]
    driven = np.zeros((len(weights), len(head.keys.names)))
    driven[:, [own[name] for name in common]] = weights[:, [told.index(name) for name in common]]

    active = driven.max(axis=0) > ACTIVE
    again = mapped(head, seen(head, driven))
    figures = {
        "weights_mae": error(again, driven, active),
        "nothing_mae": error(0.0 * driven, driven, active),
        "held_mae": error(np.repeat(driven[:1], len(driven), axis=0), driven, active),
        "channels": float(active.sum()),
        "pass_through_mae": error(mapped(head, spoken(told, weights)), driven, active),
    }
    show("roundtrip", "Weights there and back", figures, options.json)


def seen(head: Character, weights: Array) -> Performance:
    """What the head's feature points do."""
    points = head.face.points
    fields = points.at(head.keys.displacements)
    motion = np.tensordot(weights, fields, axes=1)
    neutral = points.at(head.face.vertices)
    return acted(points.ids, neutral, motion, sigma=np.full(len(points.ids), SIGMA))


def spoken(told: list[str], weights: Array) -> Performance:
    """The same weights under their own vocabulary."""
    row = {plain(name): i for i, name in enumerate(names())}
    shapes = np.zeros((len(weights), len(row)))
    for column, name in enumerate(told):
        shapes[:, row[name]] = weights[:, column]
    still = acted((), np.zeros((0, 3)), np.zeros((len(weights), 0, 3)), sigma=np.zeros(0))
    return replace(still, vocabulary="arkit", shapes=shapes)


def mapped(head: Character, performance: Performance) -> Array:
    """(F, K) weights of the head's key models."""
    curves = mien.animate(performance, head, smooth=False)
    weights = np.zeros((len(performance), len(head.keys.names)))
    weights[:, [head.keys.names.index(name) for name in curves.names]] = curves.weights
    return weights


def error(found: Array, wanted: Array, active: Array) -> float:
    """Mean absolute error over the channels that are active."""
    return float(np.abs(found - wanted)[:, active].mean())


if __name__ == "__main__":
    main()
