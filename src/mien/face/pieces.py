"""Pieces: a character's key models split softly into brow, eyes and mouth, left and right.

A performer raises one brow or sneers on one side; a key model as sculpted does neither. The
mapping therefore drives pieces, and files carry them as morph targets. The pieces of a key model
add up to it exactly.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.face.face import Array, Face

REGIONS = ("brow", "eyes", "mouth")
SIDES = ("L", "R")
WHOLE = frozenset({"jaw_open"})
"""Key models that no face does on one side: there is one jaw."""

_BLEND = 10.0
"""mm over which neighbouring masks fade into each other, on a face with pupils 63 mm apart."""
_SHARE = 0.03
"""A piece with less than this part of its key model's motion (summed squares) is not worth a
morph target: its share goes to the strongest piece."""


@dataclass(frozen=True, slots=True)
class Pieces:
    """The W morph targets a character is driven by."""

    names: tuple[str, ...]
    """(W) such as "smile_mouth_L", "blink_L", "jaw_open"."""
    key: NDArray[np.intp]
    """(W,) the key model each belongs to."""
    region: NDArray[np.intp]
    """(W,) index into REGIONS of where it mostly moves."""
    side: NDArray[np.intp]
    """(W,) 0 left, 1 right, -1 both."""
    displacements: NDArray[np.float32]
    """(W, V, 3) mm."""

    def mirrored(self) -> NDArray[np.intp]:
        """(W,) index of each piece's partner on the other side; itself where there is none."""
        row = {name: i for i, name in enumerate(self.names)}
        swap = {"L": "R", "R": "L"}
        partner = [
            name[:-1] + swap[name[-1]] if name[-2:] in ("_L", "_R") else name for name in self.names
        ]
        return np.array([row.get(p, i) for i, p in enumerate(partner)], dtype=np.intp)


def _ramp(distance: Array, width: float) -> Array:
    """0 below -width/2, 1 above width/2, smooth between."""
    t = np.clip(distance / width + 0.5, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def region_masks(face: Face, places: Array) -> Array:
    """(3, N) share of brow, eyes and mouth in each of N ``places`` (N, 3); columns sum to 1.

    The borders are level lines half-way between lid fold and brow, and between lower lid and
    cheek bone.
    """
    y = {fdp: face.point(fdp)[1] for fdp in ("3.13", "3.14", "4.3", "4.4", "3.9", "3.10", "5.3", "5.4")}
    brow_line = (y["3.13"] + y["3.14"] + y["4.3"] + y["4.4"]) / 4.0
    cheek_line = (y["3.9"] + y["3.10"] + y["5.3"] + y["5.4"]) / 4.0
    blend = _BLEND * _scale(face)
    brow = _ramp(places[:, 1] - brow_line, min(blend, 1.6 * abs(y["4.3"] - brow_line)))
    mouth = _ramp(cheek_line - places[:, 1], blend)
    return np.stack([brow, 1.0 - brow - mouth, mouth])


def side_masks(face: Face, places: Array) -> Array:
    """(2, N) share of the left and right half; columns sum to 1."""
    left = _ramp(places[:, 0], _BLEND * _scale(face))
    return np.stack([left, 1.0 - left])


def split(character: Character) -> Pieces:
    """Split the character's examples; other key models (visemes, units) stay whole."""
    face = character.face
    regions, sides = region_masks(face, face.vertices), side_masks(face, face.vertices)
    for part in face.parts:
        # What is hard must not bend at the midline: half of it goes with either side.
        if part.name.startswith(("teeth", "gum", "tongue")):
            regions[:, part.first : part.last] = np.array([[0.0], [0.0], [1.0]])
            sides[:, part.first : part.last] = 0.5
    names: list[str] = []
    tags: list[tuple[int, int, int]] = []
    fields: list[NDArray[np.float32]] = []
    for name in character.examples:
        key = character.keys.names.index(name)
        moved = character.keys.displacements[key]
        side_list = [(-1, np.ones(len(moved)))] if name in WHOLE else list(enumerate(sides))
        masks = {
            (r, s): region * side for r, region in enumerate(regions) for s, side in side_list
        }
        for (region, side), mask in _merge_weak(masks, moved).items():
            names.append(_piece_name(name, region, side, masks, moved))
            tags.append((key, region, side))
            fields.append((mask[:, None] * moved).astype(np.float32))
    key_of, region_of, side_of = np.array(tags, dtype=np.intp).reshape(-1, 3).T
    return Pieces(tuple(names), key_of, region_of, side_of, np.stack(fields))


def _merge_weak(
    masks: dict[tuple[int, int], Array], moved: NDArray[np.float32]
) -> dict[tuple[int, int], Array]:
    energy = {tag: float(((mask[:, None] * moved) ** 2).sum()) for tag, mask in masks.items()}
    best = max(energy, key=lambda tag: energy[tag])
    limit = _SHARE * sum(energy.values())
    kept = {tag: mask for tag, mask in masks.items() if energy[tag] >= limit or tag == best}
    for (region, side), mask in masks.items():
        if (region, side) not in kept:
            same_side = [tag for tag in kept if tag[1] == side]
            heir = max(same_side, key=lambda tag: energy[tag]) if same_side else best
            kept[heir] = kept[heir] + mask
    return kept


def _piece_name(
    name: str,
    region: int,
    side: int,
    masks: dict[tuple[int, int], Array],
    moved: NDArray[np.float32],
) -> str:
    kept = _merge_weak(masks, moved)
    stem = name.removesuffix("_left").removesuffix("_right")
    if len({r for r, _ in kept}) > 1:
        stem += f"_{REGIONS[region]}"
    if side < 0 or (len({s for _, s in kept}) == 1 and stem == name):
        return stem
    return f"{stem}_{SIDES[side]}"


def _scale(face: Face) -> float:
    return float(abs(face.pivots["eye_left"][0] - face.pivots["eye_right"][0])) / 63.0
