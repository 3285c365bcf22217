"""What each shape of a face does, measured where the face is felt: at its feature points.

Names are not asked. Ears, fur and horns may move as they like: there are no feature points on them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import nnls

from mien.face.character import Character
from mien.face.face import Array
from mien.face.library import generic_face
from mien.face.pieces import REGIONS, region_masks, side_masks
from mien.mapping.size import scales
from mien.vocabulary.arkit import names

SPOKEN = tuple(name for name in names() if name not in ("tongueOut", "mouthClose"))
"""ARKit's shapes that can be told by skin alone: no tongue, no corrective."""
MARGINS = (("3.1", "3.3"), ("3.2", "3.4"))
"""Upper and lower lid margin of the left and right eye."""
SIDES = ("left", "right", "both")
_NOT_SKIN = frozenset({"3.5", "3.6", "7.1"})
_STILL = 0.6
"""mm, on a face of the generic one's size: what moves no feature point as far is still."""
_CARRIED = 0.1
"""Part of what a shape moves farthest that its feature points move, to be an expression: what
hides hair or ear rings carries them away."""
_LOST = 0.87
"""Part of a movement's length that is left where less than a quarter of it, squared, is shown."""
_ONE_SIDED = 0.8
"""Part of its motion that a shape has on one side, to belong to it."""
_SHUTS = 0.5
"""Part of the lid opening by which a shape shuts an eye, to be its blink."""
_ALONE = 0.35
"""And the most of the other eye's that it may shut."""


@dataclass(frozen=True, slots=True)
class Act:
    """What one key model does."""

    name: str
    region: str
    """"brow", "eyes" or "mouth"; empty where it moves no feature point."""
    region_share: float
    """Part of its motion there."""
    side: str
    """"left", "right" or "both", the subject's."""
    left: float
    """Part of its motion on the left, 0..1."""
    like: str
    """The one of ARKit's whose motion on the generic face is most alike."""
    likeness: float
    """Cosine between the two."""
    size: float
    """mm the farthest feature point moves, on a face of the generic one's size."""
    shuts: tuple[float, float]
    """Part of the opening of the left and the right eye that it shuts."""
    still: bool
    """It moves no feature point to speak of: hair, ears, a blush."""

    @property
    def confidence(self) -> float:
        """0..1: how clearly it belongs to its region and side."""
        share = self.left if self.side == "left" else 1.0 - self.left
        clear = 1.0 - abs(2.0 * self.left - 1.0) if self.side == "both" else share
        return float(np.clip(min(self.region_share, clear), 0.0, 1.0))


def measure(character: Character) -> tuple[Act, ...]:
    """What each of the character's key models does, in their order."""
    face, keys = character.face, character.keys
    own = face.points.at(face.vertices)
    raw = np.stack([face.points.at(field) for field in keys.displacements]) if keys.names else None
    if raw is None:
        return ()
    shuts = _shuts(character, own, raw)
    ids, motion, factor = _as_on_generic(character, raw)
    place = own[face.points.index(ids)]
    effort = (motion**2).sum(axis=-1)
    regional = effort @ region_masks(face, place).T
    sided = effort @ side_masks(face, place).T
    total = np.maximum(effort.sum(axis=1), 1e-12)
    left, share = sided[:, 0] / total, regional / total[:, None]
    likeness = _cosines(motion, _generic(ids))
    size = np.sqrt(effort.max(axis=1))
    farthest = np.linalg.norm(keys.displacements, axis=2).max(axis=1, initial=0.0)
    still = (size < _STILL) | (size < _CARRIED * farthest * factor)
    return tuple(
        Act(
            name=name,
            region="" if still[k] else REGIONS[int(share[k].argmax())],
            region_share=float(share[k].max()),
            side=_side(float(left[k])),
            left=float(left[k]),
            like=SPOKEN[int(likeness[k].argmax())],
            likeness=float(likeness[k].max()),
            size=float(size[k]),
            shuts=(float(shuts[k, 0]), float(shuts[k, 1])),
            still=bool(still[k]),
        )
        for k, name in enumerate(keys.names)
    )


def unexpressed(character: Character) -> tuple[str, ...]:
    """Those of ARKit's movements, gaze apart, of which the character's examples together can show
    less than a quarter (squared lengths), as the generic face makes them."""
    points, keys = character.face.points, character.keys
    if not character.examples:
        return ()
    rows = [keys.names.index(name) for name in character.examples]
    ids, motion, _ = _as_on_generic(character, points.at(keys.displacements[rows]))
    basis = motion.reshape(len(motion), -1).T
    wanted = _generic(ids).reshape(len(SPOKEN), -1)
    left = [nnls(basis, field)[1] / np.linalg.norm(field) for field in wanted]
    # Whoever shuts both eyes shuts them, however else they move on the generic face.
    known = ("eyeLook", "eyeBlink") if character.blinks else ("eyeLook",)
    return tuple(
        name
        for name, part in zip(SPOKEN, left, strict=True)
        if part > _LOST and not name.startswith(known)
    )


def _as_on_generic(character: Character, motion: Array) -> tuple[tuple[str, ...], Array, float]:
    """The points (P) on skin, the ``motion`` (K, P, 3) of them at the generic face's size, and the
    mean of the factors that bring it there."""
    points = character.face.points
    ids = tuple(fdp for fdp in points.ids if fdp not in _NOT_SKIN)
    rows = points.index(ids)
    own = points.at(character.face.vertices)
    factors = scales(points.ids, _generic_rest(points.ids), own)[rows]
    return ids, motion[:, rows] * factors, float(factors.mean())


def blinks(acts: tuple[Act, ...]) -> frozenset[str]:
    """The key models that shut one eye each; empty where either eye has none."""
    found = []
    for eye in (0, 1):
        shutting = [
            act
            for act in acts
            if act.shuts[eye] > _SHUTS
            and act.shuts[1 - eye] < _ALONE * act.shuts[eye]
            and act.side == SIDES[eye]
        ]
        if not shutting:
            return frozenset()
        # The fullest, and of equals the one that moves least besides.
        found.append(max(shutting, key=lambda act: min(act.shuts[eye], 1.0) - 0.01 * act.size))
    return frozenset(act.name for act in found)


def _side(left: float) -> str:
    if left > _ONE_SIDED:
        return "left"
    return "right" if left < 1.0 - _ONE_SIDED else "both"


def _shuts(character: Character, own: Array, motion: Array) -> Array:
    """(K, 2) part of each eye's opening that every key model takes away."""
    points = character.face.points
    parts = []
    for upper, lower in MARGINS:
        rows = points.index((upper, lower))
        opening = own[rows[0], 1] - own[rows[1], 1]
        change = motion[:, rows[0], 1] - motion[:, rows[1], 1]
        parts.append(-change / max(opening, 1e-6))
    return np.stack(parts, axis=1)


def _generic_rest(ids: tuple[str, ...]) -> Array:
    face = generic_face().face
    return face.points.at(face.vertices)[face.points.index(ids)]


def _generic(ids: tuple[str, ...]) -> Array:
    """(50, P, 3) ARKit's shapes at the feature points of the generic face."""
    generic = generic_face()
    rows = [generic.keys.names.index(name) for name in SPOKEN]
    points = generic.face.points
    return points.at(generic.keys.displacements[rows])[:, points.index(ids)]


def _cosines(first: Array, second: Array) -> Array:
    a, b = (x.reshape(len(x), -1) for x in (first, second))
    a, b = (x / np.maximum(np.linalg.norm(x, axis=1, keepdims=True), 1e-9) for x in (a, b))
    return np.asarray(a @ b.T)
