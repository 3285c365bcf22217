"""Own examples, kind (a): moments of a performer that stand for poses of the character.

    v_j     the performer's motion at moment j                         (M, P, 3)
    t_j     weights of the character's pieces that show it             (M, W)

First the character's own examples are bent until they show those moments, by what each piece may
move at each point (the closed form of Li, Weise and Pauly 2010, per point, the prior's deviation
being what the piece moves there already); so half a pose is understood too. What the mapper still
misses at a moment is then put right by radial functions about it, [B] eq. 12: exact at each.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.errors import InputError
from mien.face.character import Character
from mien.face.pieces import Pieces
from mien.mapping.examples import Examples
from mien.numeric.bspline import cubic
from mien.performance.performance import Performance

Array = NDArray[np.float64]

_FREE = 0.15
"""Part of a piece's furthest motion by which it may learn to move any point."""
_RIDGE = 1e-2
"""Ridge of the bending, in the prior's variance: several moments of one pose may disagree."""
_ALIKE = 1e-9
_SLACK = 0.5
"""Seconds from a moment to the nearest frame, at most."""


@dataclass(frozen=True, slots=True, eq=False)
class OwnExamples:
    """M moments of one performer."""

    moments: Performance
    """M frames."""
    poses: tuple[Mapping[str, float], ...]
    """(M) weights of the character's key models that show each moment."""

    def __post_init__(self) -> None:
        if len(self.moments) != len(self.poses) or not self.poses:
            raise ValueError(f"{len(self.moments)} moments for {len(self.poses)} poses")


def own_examples(
    performance: Performance, pairs: Sequence[tuple[float, Mapping[str, float]]]
) -> OwnExamples:
    """Own examples from a performance: (seconds, pose) each. Raises InputError for a moment that
    is not in the take, or in which nobody is seen."""
    rows = []
    for seconds, _ in pairs:
        row = int(np.argmin(np.abs(performance.time - seconds)))
        if abs(performance.time[row] - seconds) > _SLACK:
            raise InputError(f"own example at {seconds:g} s: the take has no such moment")
        if performance.lost[row]:
            raise InputError(f"own example at {seconds:g} s: nobody is seen there")
        rows.append(row)
    return OwnExamples(frames_of(performance, rows), tuple(pose for _, pose in pairs))


def frames_of(performance: Performance, rows: Sequence[int]) -> Performance:
    """The frames ``rows`` of a performance, as one."""
    chosen, names = list(rows), ("time", "motion", "rotation", "translation", "gaze")
    arrays = {n: getattr(performance, n)[chosen] for n in (*names, "confidence", "lost", "unseen")}
    scalars = {name: values[chosen] for name, values in performance.scalars.items()}
    shapes = performance.shapes[chosen] if len(performance.shapes) else performance.shapes
    return replace(performance, **arrays, scalars=scalars, shapes=shapes)


def pose_weights(own: OwnExamples, character: Character, pieces: Pieces) -> Array:
    """(M, W) weights of the pieces; a pose may name whole key models or single pieces. Raises
    InputError for a key model the character has not."""
    weights = np.zeros((len(own.poses), len(pieces.names)))
    for row, pose in zip(weights, own.poses, strict=True):
        for name, level in pose.items():
            if name in pieces.names:
                row[pieces.names.index(name)] = level
            elif name in character.examples:
                row[pieces.key == character.keys.names.index(name)] = level
            else:
                raise InputError(
                    f"own example '{name}': {character.name} does not act by a key model of that "
                    "name; see 'mien character list'"
                )
    return weights


def personal(examples: Examples, wanted: Array, weights: Array) -> Examples:
    """``examples`` bent so that pieces at ``weights`` (M, W) show ``wanted`` (M, P, 3)."""
    fields = examples.pieces
    size = np.linalg.norm(fields, axis=-1)
    prior = (size + _FREE * size.max(axis=1, keepdims=True)) ** 2
    missed = wanted - np.einsum("mw,wpx->mpx", weights, fields)
    gram = np.einsum("mw,wp,nw->pmn", weights, prior, weights)
    ridge = _RIDGE * np.einsum("pmm->p", gram)[:, None, None] / len(weights)
    eye = np.eye(len(weights))
    solved = np.linalg.solve(gram + (ridge + 1e-12) * eye, missed.transpose(1, 0, 2))
    bent = fields + np.einsum("wp,mw,pmx->wpx", prior, weights, solved)
    keys = examples.keys.copy()
    np.add.at(keys, examples.owner, bent - fields)
    return replace(examples, pieces=bent, keys=keys)


class Correction:
    """What is added to a mapper's weights so that they are exact at every own example."""

    def __init__(self, places: Array, missed: Array) -> None:
        """``places`` (M, Q, 3) whitened motion of the examples, ``missed`` (M, W) what the mapper
        lacks at each. The neutral, where nothing is missed, is one more."""
        self._places = np.concatenate([np.zeros_like(places[:1]), places])
        wanted = np.concatenate([np.zeros_like(missed[:1]), missed])
        apart = np.maximum(self._distances(self._places, None), _ALIKE)
        np.fill_diagonal(apart, np.inf)
        self._width = apart.min(axis=1)
        np.fill_diagonal(apart, 0.0)
        self._radial = np.linalg.lstsq(cubic(apart / self._width), wanted, rcond=None)[0]

    def __call__(self, motion: Array, sight: Array) -> Array:
        """(F, W) for whitened ``motion`` (F, Q, 3) of which ``sight`` (F, 3, 3) is seen."""
        return np.asarray(cubic(self._distances(motion, sight) / self._width) @ self._radial)

    def _distances(self, motion: Array, sight: Array | None) -> Array:
        apart = motion[:, None] - self._places[None]
        if sight is not None:
            apart = np.einsum("fmqx,fxy->fmqy", apart, sight)
        return np.asarray(np.sqrt((apart**2).sum(axis=(2, 3))))
