"""Ways to map, beside each other, on the built-in characters.

    python benchmarks/mapping_table.py [--json]

Each character performs for itself, seen by the landmark capture's feature points: half of every
key model, noise of 1 mm on a still face, mixes of two key models, mixes of pieces (one-sided and
partial faces). Every figure is that of the worst character. Errors are of the skin, mean over
vertices and frames; "x" is the largest weight.

    published   [B]'s cardinal functions of the FAPU-normalised, whitened examples
    truncated   the same with eigenvalues below the noise's variance dropped
    ridge       the same with a ridge on the linear part
    clipped     weights clipped one by one to 0..1.2
    bounded     bounded least squares on the examples
    joint       the default mapper: drawn to the cardinal weights under bounds
"""

from __future__ import annotations

import argparse
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from mien.capture.landmarks import POINTS, SIGMA, SPANS
from mien.face.character import Character
from mien.face.library import CHARACTERS, load_character
from mien.face.pieces import Pieces, split
from mien.mapping import JointMapper, Settings
from mien.mapping.regional import RegionalCardinal
from mien.performance.acted import acted
from mien.performance.performance import Performance
from report import show

Array = NDArray[np.float64]
Way = Callable[[Performance], Array]
"""Maps a performance to weights (F, W) of pieces."""

RIDGE = Settings().linear_ridge
FRAMES = 200
CLIP = 1.2


def main() -> None:
    """Run the benchmark as told on the command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true")
    options = parser.parse_args()
    stages = [Stage.of(load_character(name)) for name in CHARACTERS]
    rows = {name: worst([judge(stage, name) for stage in stages]) for name in WAYS}
    table = Table(title="Mapping, worst of four characters")
    for column in ("way", "half: own", "other", "noise mm", "x", "pairs mm", "pieces mm"):
        table.add_column(column)
    for name, row in rows.items():
        table.add_row(name, *row.cells())
    Console().print(table)
    default = worst([rows["joint"], rows["joint, no depth"]])
    show("mapping_table", "The default mapper", default.figures(), options.json)


@dataclass(frozen=True)
class Row:
    """Figures of one way on one character."""

    half_own_min: float
    half_own_max: float
    half_other_max: float
    noise_mm: float
    noise_weight: float
    pairs_mm: float
    pairs_nothing_mm: float
    pieces_mm: float
    pieces_nothing_mm: float

    def figures(self) -> dict[str, float]:
        """By name."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__}

    def cells(self) -> list[str]:
        """As the table shows them."""
        return [
            f"{self.half_own_min:.2f}-{self.half_own_max:.2f}",
            f"{self.half_other_max:.2f}",
            f"{self.noise_mm:.2f}",
            f"{self.noise_weight:.1f}",
            f"{self.pairs_mm:.2f} of {self.pairs_nothing_mm:.2f}",
            f"{self.pieces_mm:.2f} of {self.pieces_nothing_mm:.2f}",
        ]


def worst(rows: list[Row]) -> Row:
    """The worst of every figure; errors are compared by their part of doing nothing."""
    most = {name: max(row.figures()[name] for row in rows) for name in rows[0].figures()}
    most["half_own_min"] = min(row.half_own_min for row in rows)
    for what in ("pairs", "pieces"):
        error, nothing = f"{what}_mm", f"{what}_nothing_mm"
        bad = max(rows, key=lambda row: row.figures()[error] / row.figures()[nothing])
        most[error], most[nothing] = bad.figures()[error], bad.figures()[nothing]
    return Row(**most)


@dataclass(frozen=True)
class Stage:
    """A character and its pieces, at the feature points and on the skin."""

    character: Character
    pieces: Pieces
    at_points: Array
    """(W, P, 3)"""
    on_skin: Array
    """(W, V, 3)"""
    owner: Array
    """(K, W) 1 where a piece belongs to an example."""

    @classmethod
    def of(cls, character: Character) -> Stage:
        """The stage of one character."""
        face, pieces = character.face, split(character)
        skin = face.part("skin")
        moved = pieces.displacements.astype(float)
        names = np.array([character.keys.names[key] for key in pieces.key])
        return cls(
            character,
            pieces,
            face.points.at(moved)[:, face.points.index(POINTS)],
            moved[:, skin.first : skin.last],
            (np.array(character.examples)[:, None] == names).astype(float),
        )

    def perform(self, weights: Array, noise: Array | None = None) -> Performance:
        """The character shows pieces at ``weights`` (F, W)."""
        face = self.character.face
        motion = np.tensordot(weights, self.at_points, axes=1)
        return acted(
            POINTS,
            face.points.at(face.vertices)[face.points.index(POINTS)],
            motion if noise is None else motion + noise,
            sigma=SIGMA,
            spans=SPANS,
        )

    def skin(self, weights: Array) -> Array:
        """(F, V, 3) motion of the skin."""
        return np.asarray(np.tensordot(weights, self.on_skin, axes=1))


def judge(stage: Stage, name: str) -> Row:
    """All figures of one way on one character."""
    rng = np.random.default_rng(5)
    count = len(stage.character.examples)
    halves = 0.5 * stage.owner
    performance = stage.perform(halves)
    mapper = JointMapper(stage.character, performance)
    way = WAYS[name](stage, performance)
    half = mapper.by_key(way(performance))
    own = np.diag(half)
    noise = rng.normal(0.0, 1.0, (FRAMES, len(POINTS), 3))
    shaken = way(stage.perform(np.zeros((FRAMES, len(stage.pieces.names))), noise))
    pairs = np.stack([rng.permutation(count)[:2] for _ in range(FRAMES)])
    mixed = np.zeros((FRAMES, count))
    np.put_along_axis(mixed, pairs, rng.uniform(0.2, 0.8, pairs.shape), axis=1)
    partial = rng.uniform(0, 1, (FRAMES, len(stage.pieces.names)))
    partial *= rng.random(partial.shape) < 4.0 / partial.shape[1]
    errors = [_error(stage, way, weights) for weights in (mixed @ stage.owner, partial)]
    return Row(
        own.min(),
        own.max(),
        np.abs(half - np.diag(own)).max(),
        float(np.linalg.norm(stage.skin(shaken), axis=-1).mean()),
        float(np.abs(shaken).max()),
        *errors[0],
        *errors[1],
    )


def _error(stage: Stage, way: Way, weights: Array) -> tuple[float, float]:
    true = stage.skin(weights)
    guess = stage.skin(way(stage.perform(weights)))
    return (
        float(np.linalg.norm(guess - true, axis=-1).mean()),
        float(np.linalg.norm(true, axis=-1).mean()),
    )


def _cardinal(ridge: float, threshold: float = 0.0, clip: bool = False) -> Callable[..., Way]:
    def build(stage: Stage, header: Performance) -> Way:
        mapper = JointMapper(stage.character, header)
        functions = RegionalCardinal(mapper.examples, mapper.pieces, mapper.rows, ridge, threshold)

        def weights(performance: Performance) -> Array:
            cardinal = functions(mapper.rows(performance.motion[:, mapper.rows.points]))
            return cardinal.clip(0.0, CLIP) if clip else cardinal

        return weights

    return build


def _joint(settings: Settings, depth: bool = True) -> Callable[..., Way]:
    def build(stage: Stage, header: Performance) -> Way:
        mapper = JointMapper(stage.character, header, settings)
        if depth:
            return lambda performance: mapper(performance).weights
        return lambda performance: mapper(_without_depth(performance)).weights

    return build


def _without_depth(performance: Performance) -> Performance:
    unseen = np.tile([0.0, 0.0, 1.0], (len(performance), 1))
    return replace(performance, motion=performance.motion * [1.0, 1.0, 0.0], unseen=unseen)


WAYS: dict[str, Callable[[Stage, Performance], Way]] = {
    "published": _cardinal(0.0),
    "truncated": _cardinal(0.0, threshold=1.0),
    "ridge": _cardinal(RIDGE),
    "published, clipped": _cardinal(0.0, clip=True),
    "ridge, clipped": _cardinal(RIDGE, clip=True),
    "bounded": _joint(Settings(coupling=0.0)),
    "joint": _joint(Settings()),
    "joint, no depth": _joint(Settings(), depth=False),
}


if __name__ == "__main__":
    main()
