"""Which key model to sculpt next: the one that takes with it most of what these takes showed and
the character's key models do not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.errors import InputError
from mien.face.character import Character
from mien.mapping.joint import JointMapper
from mien.mapping.settings import Settings
from mien.numeric.qp import solve_boxes
from mien.performance.performance import Performance

Array = NDArray[np.float64]

_FRAMES = 150
"""Of all takes together, evenly."""
_RIDGE = 0.3
_LITTLE = 1e-9
_NO_POINTS_TELL = ("eyeLook", "mouthClose", "tongueOut", "cheekPuff", "cheek_puff")


@dataclass(frozen=True, slots=True)
class Suggestion:
    """A key model worth having."""

    name: str
    before: float
    after: float
    """Error of the takes without it and with it, over doing nothing."""


def order(
    motion: Array, known: Array, candidates: Array, count: int
) -> tuple[list[int], list[float]]:
    """Candidates by what each adds, greedily, and the error before any and after each.

    ``motion`` (F, N), ``known`` (K, N) and ``candidates`` (C, N) in standard errors. The error is
    the root mean square of what key models with weights from 0 to 1.15 leave, over doing nothing.
    """
    chosen: list[int] = []
    errors = [_error(motion, known)]
    while len(chosen) < min(count, len(candidates)):
        left = [c for c in range(len(candidates)) if c not in chosen]
        have = np.concatenate([known, candidates[chosen]])
        tried = [_error(motion, np.concatenate([have, candidates[[c]]])) for c in left]
        best = int(np.argmin(tried))
        chosen.append(left[best])
        errors.append(tried[best])
    return chosen, errors


def suggest(
    character: Character,
    takes: Sequence[Performance],
    source: Character,
    names: Sequence[str],
    count: int,
) -> list[Suggestion]:
    """The ``count`` of ``source``'s key models ``names`` that ``character`` lacks most for
    ``takes``, best first. Raises InputError where takes and character have too little in
    common."""
    if not takes:
        raise InputError("suggest: name takes to judge by")
    motions, knowns, wishes = [], [], []
    ids = _common([character, source], takes)
    for take in takes:
        own, theirs = _fields(character, take, ids), _fields(_only(source, names), take, ids)
        sight = _sight(take, ids)
        every = max(1, len(take) * len(takes) // _FRAMES)
        rows = [take.points.index(fdp) for fdp in ids]
        seen = np.flatnonzero(~take.lost)[::every]
        motions.append((take.motion[seen][:, rows] * sight).reshape(len(seen), -1))
        knowns.append((own * sight).reshape(len(own), -1))
        wishes.append((theirs * sight).reshape(len(theirs), -1))
    # Performers differ in size; their mean is near enough to choose by.
    known, wish = np.mean(knowns, axis=0), np.mean(wishes, axis=0)
    chosen, errors = order(np.concatenate(motions), known, wish, count)
    return [
        Suggestion(names[c], before, after)
        for c, before, after in zip(chosen, errors[:-1], errors[1:], strict=True)
    ]


def lacking(character: Character, source: Character) -> list[str]:
    """The key models of ``source`` that ``character`` has under no name, as far as feature points
    can tell of them."""
    has = {*character.keys.names, *character.meanings.values()}
    return [
        name
        for name in source.keys.names
        if name not in has and not name.startswith(_NO_POINTS_TELL)
    ]


def _common(characters: Sequence[Character], takes: Sequence[Performance]) -> tuple[str, ...]:
    first = takes[0].points
    kept = [set(c.face.points.ids) for c in characters] + [set(t.points) for t in takes]
    return tuple(fdp for fdp in first if all(fdp in ids for ids in kept) and fdp not in _NOT_SKIN)


_NOT_SKIN = frozenset({"3.5", "3.6", "7.1"})


def _only(source: Character, names: Sequence[str]) -> Character:
    return replace(source, examples=tuple(names), whole=True)


def _fields(character: Character, take: Performance, ids: Sequence[str]) -> Array:
    """(W, P, 3) mm of the pieces of a character at points ``ids``, at the performer's size."""
    examples = JointMapper(character, take, Settings()).examples
    return examples.pieces[:, [examples.points.index(fdp) for fdp in ids]]


def _sight(take: Performance, ids: Sequence[str]) -> Array:
    """(P, 3) one over the standard error; 0 along what was not seen."""
    seen = 1.0 - np.abs(take.unseen).mean(axis=0)
    rows = [take.points.index(fdp) for fdp in ids]
    return np.asarray(np.where(seen > 0.5, 1.0, 0.0) / take.sigma[rows])


def _error(motion: Array, fields: Array) -> float:
    gram = fields @ fields.T
    size = len(fields)
    hessian = gram + (_RIDGE + _LITTLE * gram.max(initial=1.0)) * np.eye(size)
    weights = solve_boxes(
        hessian[None], -motion @ fields.T, np.zeros(size), np.full(size, Settings().bound)
    )
    left = motion - weights @ fields
    return float(np.sqrt((left**2).sum() / max((motion**2).sum(), _LITTLE)))
