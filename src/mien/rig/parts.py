"""A model's parts as a face has them: skin, eyeballs, what else the head carries, and the body."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.face.face import Array, Ints, Part
from mien.face.model import Model
from mien.rig.components import Ball

EYES = ("eye_left", "eye_right")
_LONGEST = 100


def parts_of(
    model: Model,
    part: NDArray[np.intp],
    vertices: Array,
    skin: Ints,
    balls: tuple[Ball, Ball] | None,
    neck: float,
) -> tuple[NDArray[np.intp], list[Part]]:
    """The order (V,) in which parts are runs of vertices, and the parts, their triangles still in
    the model's numbers.

    ``part`` (V,) numbers the connected parts of ``vertices`` (V, 3); those whose middle lies below
    ``neck`` belong to the body.
    """
    owner = np.repeat(np.arange(len(model.parts)), [len(p.vertices) for p in model.parts])
    kinds = [(piece.name[:_LONGEST], "other", "head") for piece in model.parts]
    for number in np.unique(owner[np.unique(skin)]):
        kinds[number] = (kinds[number][0], "skin", "head")
    if balls is not None:
        for eye, ball in zip(EYES, balls, strict=True):
            owner[ball.vertices] = len(kinds)
            kinds.append((eye, "eye", eye))
    count = np.bincount(part)
    middle = np.bincount(part, weights=vertices[:, 1]) / np.maximum(count, 1)
    below = (middle < neck)[part]
    for number, (name, material, _) in enumerate(kinds[: len(model.parts)]):
        own = below & (owner == number)
        if own.any():
            owner[own] = len(kinds)
            kinds.append((f"{name} below", material, "body"))
    return np.argsort(owner, kind="stable"), _runs(owner, kinds, model.triangles)


def _runs(
    owner: NDArray[np.intp], kinds: list[tuple[str, str, str]], triangles: Ints
) -> list[Part]:
    parts: list[Part] = []
    start = 0
    of_triangle = owner[triangles[:, 0]]
    for number, (name, material, follows) in enumerate(kinds):
        size = int((owner == number).sum())
        if not size:
            continue
        taken = {part.name for part in parts}
        shown = (name or "part") if name not in taken else f"{name} {number}"
        own = triangles[of_triangle == number]
        parts.append(Part(shown, material, start, start + size, own, follows))
        start += size
    return parts
