"""Wires (Singh and Fiume 1998; [B] §2): feature curves of a face that carry the skin about them.

    R      wire at rest: a curve through the feature points it is named by
    W - R  its displacement: that of its control points, carried along the curve
    p_R    place on the wire nearest to a point of the face, along the skin
    f      falloff (1 - x²)² of that distance x, in reaches
    F      share of one wire among all that reach a point

A key model is the displacements of its wires and a residual, which is what no wire explains; the
residual is shared out among the wires too. So a key model falls into one piece a wire, and the
pieces add up to it: whatever is blended wire by wire, all wires at one key model's displacement
give that key model back.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy import sparse
from scipy.sparse.csgraph import dijkstra

from mien.face.character import Character, KeyModels
from mien.face.face import Array, Face, Part
from mien.face.pieces import REGIONS, WHOLE, Pieces

WIRES: Mapping[str, tuple[str, str, tuple[str, ...]]] = {
    "brow_left": ("brow", "L", ("4.1", "4.3", "4.5")),
    "brow_right": ("brow", "R", ("4.2", "4.4", "4.6")),
    "upper_lid_left": ("eyes", "L", ("3.11", "3.1", "3.7")),
    "upper_lid_right": ("eyes", "R", ("3.8", "3.2", "3.12")),
    "lower_lid_left": ("eyes", "L", ("3.9", "3.3")),
    "lower_lid_right": ("eyes", "R", ("3.10", "3.4")),
    "cheek_left": ("mouth", "L", ("5.3", "5.1")),
    "cheek_right": ("mouth", "R", ("5.4", "5.2")),
    "nose_left": ("mouth", "L", ("9.1", "9.5")),
    "nose_right": ("mouth", "R", ("9.2", "9.4")),
    "upper_lip_left": ("mouth", "L", ("8.10", "8.5", "8.3")),
    "upper_lip_right": ("mouth", "R", ("8.9", "8.6", "8.4")),
    "lower_lip_left": ("mouth", "L", ("8.7", "2.8")),
    "lower_lip_right": ("mouth", "R", ("8.8", "2.9")),
    "upper_lip": ("mouth", "", ("8.1", "2.2")),
    "lower_lip": ("mouth", "", ("8.2", "2.3")),
    "chin": ("mouth", "", ("2.10", "2.1")),
}
"""Region, side and control points of each. A point belongs to one wire."""
SEPARATOR = "@"
"""Between a key model and a wire in the name of a piece: "smile@upper_lip_left"."""

_REACH = 0.45
"""How far a wire reaches, in distances of the pupils."""
_TOUCH = 1.0
"""mm from a wire within which nothing else has a share."""
_SHARP = 3.0
"""Power of distance by which shares fall."""
_SAMPLES = 12
"""Places along a wire from which distances on the skin are measured."""
_HARD = ("teeth", "gum", "tongue")
_VISIBLE = 0.4
"""mm on a face with pupils 63 mm apart: a piece that moves less joins the strongest one."""


@dataclass(frozen=True, slots=True, eq=False)
class Wires:
    """The J wires a face has, and how its V vertices hang on them."""

    names: tuple[str, ...]
    points: tuple[tuple[str, ...], ...]
    """Control points of each, those the face has."""
    share: NDArray[np.float32]
    """(J, V) columns sum to 1."""
    falloff: NDArray[np.float32]
    """(J, V) f times the share: how far a vertex follows the wire."""
    along: tuple[NDArray[np.float32], ...]
    """(V, C) each: weights of a wire's control points at the place nearest to each vertex."""

    def carried(self, wire: int, moved: Array) -> Array:
        """(V, 3) displacement of the face under wire ``wire`` whose control points move by
        ``moved`` (C, 3)."""
        return np.asarray(self.falloff[wire][:, None] * (self.along[wire] @ moved))


@lru_cache(maxsize=8)
def wires_of(character: Character) -> Wires:
    """The wires of a character's face, of whose control points it has at least one each. Kept:
    do not write into them. Raises ValueError where there is none."""
    face = character.face
    known = {
        name: tuple(p for p in ids if p in face.points.ids) for name, (*_, ids) in WIRES.items()
    }
    names = tuple(name for name, ids in known.items() if ids)
    if not names:
        raise ValueError("no feature points to run wires through")
    places = face.points.at(face.vertices)
    reach = _REACH * float(np.linalg.norm(face.pivots["eye_left"] - face.pivots["eye_right"]))
    graph = _edges(face)
    distances, along = [], []
    for name in names:
        control = places[face.points.index(known[name])]
        samples, blend = _sampled(control)
        distance, nearest = _over_skin(face, graph, samples)
        distances.append(distance)
        along.append(blend[nearest].astype(np.float32))
    distance = np.stack(distances)
    closeness = np.maximum(distance, _TOUCH) ** -_SHARP
    hard = _hard(face)
    if hard.any() and "chin" in names:
        closeness[:, hard] = 0.0
        closeness[names.index("chin"), hard] = 1.0
    share = closeness / closeness.sum(axis=0)
    fall = np.clip(1.0 - (distance / reach) ** 2, 0.0, 1.0) ** 2
    points = tuple(known[name] for name in names)
    return Wires(
        names, points, share.astype(np.float32), (share * fall).astype(np.float32), tuple(along)
    )


def control_motion(character: Character, key: str) -> dict[str, Array]:
    """Displacement (3,) mm of every control point in a key model, by FDP id."""
    wires = wires_of(character)
    moved = character.face.points.at(character.keys[key])
    ids = [fdp for points in wires.points for fdp in points]
    rows = character.face.points.index(ids)
    return {fdp: moved[row] for fdp, row in zip(ids, rows, strict=True)}


def with_moved_wires(character: Character, key: str, moved: Mapping[str, Array]) -> Character:
    """``character`` whose key model ``key`` has its wires' control points displaced as ``moved``
    says (3,) mm each, by FDP id; the others stay and the residual is kept. Raises KeyError for a
    key model or a control point that is not there."""
    wires, before = wires_of(character), control_motion(character, key)
    for fdp in moved:
        before[fdp]
    field = character.keys[key].astype(float)
    for wire, ids in enumerate(wires.points):
        change = np.stack([np.asarray(moved.get(fdp, before[fdp])) - before[fdp] for fdp in ids])
        field = field + wires.carried(wire, change)
    fields = character.keys.displacements.copy()
    fields[character.keys.names.index(key)] = field
    return replace(character, keys=KeyModels(character.keys.names, fields))


@lru_cache(maxsize=4)
def wire_pieces(character: Character) -> Pieces:
    """The character's examples in one piece a wire. Kept: do not write into them. Raises
    ValueError where the face has no wires."""
    wires = wires_of(character)
    scale = (
        float(
            np.linalg.norm(character.face.pivots["eye_left"] - character.face.pivots["eye_right"])
        )
        / 63.0
    )
    names: list[str] = []
    fields: list[NDArray[np.float32]] = []
    keys: list[int] = []
    owners: list[int] = []
    for example in character.examples:
        key = character.keys.names.index(example)
        for wire, field in _split(character, wires, example, _VISIBLE * scale):
            names.append(f"{example}{SEPARATOR}{wires.names[wire]}")
            fields.append(field)
            keys.append(key)
            owners.append(wire)
    regions = [REGIONS.index(WIRES[wires.names[wire]][0]) for wire in owners]
    sides = [{"L": 0, "R": 1, "": -1}[WIRES[wires.names[wire]][1]] for wire in owners]
    cells = np.zeros((len(names), len(REGIONS), 2), dtype=bool)
    for row, (region, side) in enumerate(zip(regions, sides, strict=True)):
        cells[row, region, side if side >= 0 else slice(None)] = True
    return Pieces(
        names=tuple(names),
        key=np.array(keys, dtype=np.intp),
        region=np.array(regions, dtype=np.intp),
        side=np.array(sides, dtype=np.intp),
        cells=cells,
        displacements=np.stack(fields),
    )


def is_wire_piece(name: str) -> bool:
    """Whether a target's name is one that ``wire_pieces`` gives."""
    return SEPARATOR in name


def _split(
    character: Character, wires: Wires, key: str, visible: float
) -> list[tuple[int, NDArray[np.float32]]]:
    """The wires that move in a key model, and the part of it that goes with each."""
    whole = character.keys[key]
    moved = character.face.points.at(whole)
    carried = np.stack(
        [
            wires.carried(wire, moved[character.face.points.index(ids)])
            for wire, ids in enumerate(wires.points)
        ]
    )
    residual = whole - carried.sum(axis=0)
    parts = carried + wires.share[..., None] * residual
    peak = np.linalg.norm(parts, axis=-1).max(axis=1)
    top = int(peak.argmax())
    kept = peak >= visible
    kept[top] = True
    if key in WHOLE or key in character.blinks:
        heirs = _together(wires, key in character.blinks, peak, top)
    else:
        heirs = {wire: wire if kept[wire] else top for wire in range(len(peak))}
    taken = {h: [w for w in heirs if heirs[w] == h] for h in sorted(set(heirs.values()))}
    pieces = {heir: parts[rows].sum(axis=0).astype(np.float32) for heir, rows in taken.items()}
    # What single precision rounds away goes to the strongest, that the pieces add up.
    lost = whole - np.sum(list(pieces.values()), axis=0, dtype=float)
    pieces[heirs[top]] = (pieces[heirs[top]] + lost).astype(np.float32)
    return list(pieces.items())


def _together(wires: Wires, blink: bool, peak: Array, top: int) -> dict[int, int]:
    """Which wire takes each one's part of a key model that is not taken apart: a jaw is one, and
    a lid goes with the other lid of its eye."""
    if not blink:
        return dict.fromkeys(range(len(peak)), top)
    heirs = {}
    best = {
        side: max(
            (
                w
                for w, name in enumerate(wires.names)
                if name in (f"upper_lid_{side}", f"lower_lid_{side}")
            ),
            key=lambda w: peak[w],
            default=top,
        )
        for side in ("left", "right")
    }
    least = 0.2 * peak[list(best.values())].max()
    for wire, name in enumerate(wires.names):
        side = "right" if name.endswith("right") else "left" if name.endswith("left") else None
        heirs[wire] = top if side is None or peak[best[side]] < least else best[side]
    return heirs


def _sampled(control: Array) -> tuple[Array, Array]:
    """Places (S, 3) along the wire through ``control`` (C, 3), and the weights (S, C) of the
    control points at each: a Catmull-Rom curve, linear in its control points."""
    count = len(control)
    if count == 1:
        return control, np.ones((1, 1))
    ends = np.concatenate(
        [
            2 * np.eye(count)[:1] - np.eye(count)[1:2],
            np.eye(count),
            2 * np.eye(count)[-1:] - np.eye(count)[-2:-1],
        ]
    )
    at = np.linspace(0.0, count - 1.0, _SAMPLES)
    first = np.minimum(at.astype(int), count - 2)
    t = (at - first)[:, None]
    a, b, c, d = (ends[first + k] for k in range(4))
    blend = 0.5 * (
        2 * b + (c - a) * t + (2 * a - 5 * b + 4 * c - d) * t**2 + (3 * b - a - 3 * c + d) * t**3
    )
    return blend @ control, blend


def _edges(face: Face) -> sparse.csr_matrix:
    """(V, V) lengths of the edges."""
    triangles = face.triangles
    here, there = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    length = np.linalg.norm(face.vertices[here] - face.vertices[there], axis=1)
    count = len(face.vertices)
    return sparse.csr_matrix((np.maximum(length, 1e-6), (here, there)), (count, count))


def _over_skin(
    face: Face, graph: sparse.csr_matrix, samples: Array
) -> tuple[Array, NDArray[np.intp]]:
    """Distance (V,) mm over the surface to the nearest of ``samples`` (S, 3), and which (V,).
    What the surface does not join is measured through the air."""
    straight = np.linalg.norm(face.vertices[:, None] - samples[None], axis=-1)
    skin = _skin(face)
    start = skin.first + straight[skin.first : skin.last].argmin(axis=0)
    distance = dijkstra(graph, directed=False, indices=np.unique(start), min_only=True)
    air = ~np.isfinite(distance)
    nearest = straight.argmin(axis=1)
    return np.where(air, straight.min(axis=1), np.maximum(distance, straight.min(axis=1))), nearest


def _skin(face: Face) -> Part:
    """The part on which most of the feature points lie: lashes and brows may be nearer."""
    at = face.points.vertices[:, 0]
    return max(face.parts, key=lambda part: int(((at >= part.first) & (at < part.last)).sum()))


def _hard(face: Face) -> NDArray[np.bool_]:
    """(V,) what must not bend."""
    hard = np.zeros(len(face.vertices), dtype=bool)
    for part in face.parts:
        hard[part.first : part.last] = part.name.startswith(_HARD)
    return hard
