"""Pieces: a character's key models split softly into brow, eyes and mouth, left and right.

A performer raises one brow or sneers on one side; a key model as sculpted does neither. The
mapping therefore drives pieces, and files carry them as morph targets. The pieces of a key model
add up to it exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.face.face import Array, Face

REGIONS = ("brow", "eyes", "mouth")
SIDES = ("L", "R")
WHOLE = frozenset({"jaw_open"})
"""Key models that no face does in parts: there is one jaw."""

Cells = NDArray[np.bool_]

_MIDLINE = 24.0
"""mm over which left fades into right: lips pulled to one side must bend and not break."""
_BLEND = 10.0
"""mm over which neighbouring masks fade into each other, on a face with pupils 63 mm apart."""
_BROW = (("4.1", "4.2"), ("4.3", "4.4"), ("4.5", "4.6"))
_UPPER_LID = (("3.11", "3.8"), ("3.13", "3.14"), ("3.7", "3.12"))
"""Left and right: inner end, arch, outer end."""
_BETWEEN = 0.8
"""Part of what lies between brow and lid over which they fade into each other, at most ..."""
_LEAST_BLEND = 0.25
"""... and at least, of _BLEND."""
_VISIBLE = 1.2
"""mm on that face: a piece whose skin nowhere moves as far is not worth a morph target, and its
share goes to the strongest piece. (Not a share of the summed motion: a falling jaw moves so much
skin that the brows of the same surprise would count for nothing.)"""
_ONE_SIDED = 0.8
"""Part of its motion that a whole key model has on one side, to belong to it."""
_TWIN = 0.8
"""A piece may be this much weaker where its partner on the other side is kept, lest a face that
is symmetric but for rounding loses one of the two."""


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
    cells: Cells
    """(W, 3, 2) the regions and sides each gathers; those of one key model share them all out."""
    displacements: NDArray[np.float32]
    """(W, V, 3) mm."""

    def mirrored(self) -> NDArray[np.intp]:
        """(W,) index of each piece's partner on the other side; itself where there is none."""
        row = {name: i for i, name in enumerate(self.names)}
        swap = {"_L": "_R", "_R": "_L"}
        partner = [name[:-2] + swap.get(name[-2:], name[-2:]) for name in self.names]
        return np.array([row.get(p, i) for i, p in enumerate(partner)], dtype=np.intp)


def region_masks(face: Face, places: Array) -> Array:
    """(3, N) share of brow, eyes and mouth in each of N ``places`` (N, 3); columns sum to 1.

    One border runs half-way between the brow and the arch of the upper lid, as far as the face
    has the points; the other is level, half-way between lower lid and cheek bone.
    """
    blend = _BLEND * _scale(face)
    lid, cheek = _level(face, "3.9", "3.10"), _level(face, "5.3", "5.4")
    # On large eyes the cheek bone is no lower than the lid, which must stay with its eye.
    cheek_line = min((lid + cheek) / 2.0, lid - blend / 2.0)
    width, height = np.abs(places[:, 0]), places[:, 1]
    brow, upper_lid = _brow_line(face, width), _lid_line(face, width)
    room = np.clip(_BETWEEN * (brow - upper_lid), _LEAST_BLEND * blend, blend)
    above = _ramp(height - (brow + upper_lid) / 2.0, room)
    below = _ramp(cheek_line - height, blend)
    return np.stack([above, 1.0 - above - below, below])


def _brow_line(face: Face, width: Array) -> Array:
    """(N,) height of the brows ``width`` (N,) from the middle."""
    ends = [_place(face, pair) for pair in _BROW if set(pair) <= set(face.points.ids)]
    return np.asarray(np.interp(width, *np.transpose(sorted(ends))))


def _lid_line(face: Face, width: Array) -> Array:
    """(N,) height of the upper lids' fold: an arch between the corners, level beyond."""
    if not all(set(pair) <= set(face.points.ids) for pair in _UPPER_LID):
        return np.full_like(width, _place(face, _UPPER_LID[1])[1])
    (inner, low), (middle, high), (outer, end) = (_place(face, pair) for pair in _UPPER_LID)
    aside = np.where(
        width < middle, (middle - width) / (middle - inner), (width - middle) / (outer - middle)
    )
    foot = np.where(width < middle, low, end)
    return np.asarray(high - (high - foot) * np.clip(aside, 0.0, 1.0) ** 2)


def _place(face: Face, pair: tuple[str, str]) -> tuple[float, float]:
    """Distance from the middle and height of a point that both sides have."""
    left, right = (face.point(fdp) for fdp in pair)
    return float(abs(left[0]) + abs(right[0])) / 2.0, float(left[1] + right[1]) / 2.0


def _level(face: Face, left: str, right: str) -> float:
    return float(face.point(left)[1] + face.point(right)[1]) / 2.0


def side_masks(face: Face, places: Array) -> Array:
    """(2, N) share of the left and right half; columns sum to 1."""
    left = _ramp(places[:, 0], _MIDLINE * _scale(face))
    return np.stack([left, 1.0 - left])


def shares(cells: Cells, regions: Array, sides: Array) -> Array:
    """(W, N) part of its key model that each piece has in N places, from their masks (3, N) and
    (2, N)."""
    return np.asarray(np.einsum("wrs,rn,sn->wn", cells.astype(float), regions, sides))


@lru_cache(maxsize=8)
def split(character: Character) -> Pieces:
    """Split the character's examples; other key models (visemes, units) stay whole.

    Everything that drives, draws or writes a character asks for its pieces, so they are kept: do
    not write into them.
    """
    if character.whole:
        return _whole(character)
    face = character.face
    regions, sides = region_masks(face, face.vertices), side_masks(face, face.vertices)
    for part in face.parts:
        # What is hard must not bend at the midline: half of it goes with either side.
        if part.name.startswith(("teeth", "gum", "tongue")):
            regions[:, part.first : part.last] = np.array([[0.0], [0.0], [1.0]])
            sides[:, part.first : part.last] = 0.5
    visible = _VISIBLE * _scale(face)
    names: list[str] = []
    keys: list[int] = []
    cells: list[Cells] = []
    strongest: list[tuple[int, int]] = []
    fields: list[NDArray[np.float32]] = []
    for name in character.examples:
        key = character.keys.names.index(name)
        moved = character.keys.displacements[key]
        peak = (regions[:, None] * sides[None] * np.linalg.norm(moved, axis=-1)).max(axis=-1)
        found = _gather(peak, visible, name, name in character.blinks)
        mask = shares(np.stack([gathered for _, _, gathered in found]), regions, sides)
        fields.append(mask.astype(np.float32)[..., None] * moved)
        cells.extend(gathered for _, _, gathered in found)
        strongest.extend((region, side) for region, side, _ in found)
        keys.extend([key] * len(found))
        places = [(region, side) for region, side, _ in found]
        names.extend(_piece_names(name, places, character.examples))
    region_of, side_of = np.array(strongest, dtype=np.intp).reshape(-1, 2).T
    return Pieces(
        names=tuple(names),
        key=np.array(keys, dtype=np.intp),
        region=region_of,
        side=side_of,
        cells=np.array(cells, dtype=bool).reshape(-1, len(REGIONS), len(SIDES)),
        displacements=np.concatenate(fields),
    )


def _whole(character: Character) -> Pieces:
    """The examples unsplit, each with the region and the side in which its feature points move."""
    face, names = character.face, character.examples
    rows = [character.keys.names.index(name) for name in names]
    places = face.points.at(face.vertices)
    regions, sides = region_masks(face, places), side_masks(face, places)
    fields = character.keys.displacements[rows]
    effort = np.linalg.norm(face.points.at(fields), axis=-1) ** 2
    regional, sided = effort @ regions.T, effort @ sides.T
    left = sided[:, 0] / np.maximum(sided.sum(axis=1), 1e-12)
    return Pieces(
        names=names,
        key=np.array(rows, dtype=np.intp),
        region=regional.argmax(axis=1),
        side=np.select([left > _ONE_SIDED, left < 1.0 - _ONE_SIDED], [0, 1], -1),
        cells=np.ones((len(names), len(REGIONS), len(SIDES)), dtype=bool),
        displacements=fields,
    )


def _ramp(distance: Array, width: Array | float) -> Array:
    """0 below -width/2, 1 above width/2, smooth between."""
    t = np.clip(distance / width + 0.5, 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


def _gather(peak: Array, visible: float, name: str, blink: bool) -> list[tuple[int, int, Cells]]:
    """Which pieces a key model falls into: region, side (-1 both) and cells (3, 2) of each, from
    the furthest motion ``peak`` (3, 2) in every cell. Weak cells join the strongest piece of their
    side."""
    top_region, top_side = np.unravel_index(np.argmax(peak), peak.shape)
    if name in WHOLE:
        return [(int(top_region), -1, np.ones(peak.shape, dtype=bool))]
    kept = (peak >= visible) | ((peak >= _TWIN * visible) & (peak[:, ::-1] >= visible))
    if blink:
        kept[np.arange(len(peak)) != top_region] = False
    kept[top_region, top_side] = True
    cells = {(int(r), int(s)): np.zeros(peak.shape, dtype=bool) for r, s in np.argwhere(kept)}
    for region, side in np.ndindex(*peak.shape):
        heir_side = side if kept[:, side].any() else int(top_side)
        strongest = int(np.argmax(np.where(kept[:, heir_side], peak[:, heir_side], -1.0)))
        heir = (region, side) if kept[region, side] else (strongest, heir_side)
        cells[heir][region, side] = True
    return [(region, side, gathered) for (region, side), gathered in cells.items()]


def _piece_names(name: str, places: list[tuple[int, int]], keys: Sequence[str]) -> list[str]:
    """Names of one key model's pieces: its own, then the region where it has several, then the
    side. "blink_left", which moves one side alone, becomes "blink_L", unless there is a "blink"
    among the ``keys`` whose pieces are called so."""
    one_sided = len({side for _, side in places}) == 1
    stem = name.removesuffix("_left").removesuffix("_right") if one_sided else name
    if stem in keys:
        stem = name
    names = []
    for region, side in places:
        where = f"_{REGIONS[region]}" if len({r for r, _ in places}) > 1 else ""
        which = "" if side < 0 or (one_sided and stem == name) else f"_{SIDES[side]}"
        names.append(f"{stem}{where}{which}")
    return names


def _scale(face: Face) -> float:
    return float(abs(face.pivots["eye_left"][0] - face.pivots["eye_right"][0])) / 63.0
