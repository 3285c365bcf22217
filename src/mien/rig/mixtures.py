"""Expressions of a VRM that mix several morph targets: which of them act, each as one.

What its artist mixed belongs together: lids with their lashes, a mouth with its teeth. But a
mixture that other expressions show as well (joy as half an "oh" and a glance) would only take
their weights away, and targets that speak ARKit by themselves say more than any mixture of them.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from scipy.optimize import nnls

from mien.face.character import Character
from mien.face.model import Shape
from mien.rig.acts import Act
from mien.rig.spoken import arkit_keys

_NEW = 0.5
"""Part of a mixture's motion, at feature points, that no whole expression shows."""


def silent(character: Character, shapes: Sequence[Shape], acts: Sequence[Act]) -> frozenset[str]:
    """Names of those key models that do not act because a mixture does it for them or they for a
    mixture. ``acts`` belong to the character's key models."""
    known = {shape.name: shape for shape in shapes}
    mixed = {name for name, shape in known.items() if shape.expression and len(shape.binds) > 1}
    plain = {name for name, shape in known.items() if not shape.expression}
    if not mixed or arkit_keys([act for act in acts if act.name in plain]):
        return frozenset(mixed)
    parts = _targets(known[name] for name in mixed)
    held = {name for name in plain if _targets([known[name]]) <= parts}
    moving = {act.name for act in acts if not act.still}
    units = _new(character, moving & mixed, moving - mixed - held)
    taken = _targets(known[name] for name in units)
    return frozenset(mixed - units | {name for name in held if _targets([known[name]]) <= taken})


def _targets(shapes: Iterable[Shape]) -> set[tuple[int, int]]:
    return {(bind.mesh, bind.target) for shape in shapes for bind in shape.binds}


def _new(character: Character, mixed: set[str], others: set[str]) -> set[str]:
    """Those of ``mixed`` that show what ``others`` together do not."""
    points, keys = character.face.points, character.keys
    motion = {name: points.at(keys[name].astype(float)).ravel() for name in sorted(mixed | others)}
    basis = np.stack([motion[name] for name in sorted(others)], axis=1) if others else None
    found = set()
    for name in mixed:
        field = motion[name]
        left = np.linalg.norm(field) if basis is None else nnls(basis, field)[1]
        if left > _NEW * np.linalg.norm(field):
            found.add(name)
    return found
