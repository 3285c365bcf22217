"""The FAP basis C of a face: what each animation parameter does to all its vertices ([C] eq. 2).

Each FAP moves its own feature point by its value times its unit along its axis, exactly, and no
other point along an axis in which another FAP moves that; FAPs that turn the head or an eye are
rotations and have no field. What a face does beyond that is in ``fap_targets``.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.errors import InputError
from mien.face import fap_parts
from mien.face.face import Array, Face, Part
from mien.face.fap_lids import lids
from mien.face.fap_lips import OUTER_LIPS, hang_lining
from mien.face.fap_skin import CHIN, Skin, skin, skin_of
from mien.face.influence import LIPS, Mask, rows, sewn_up
from mien.vocabulary.fap import PER_UNIT, column, faps, simple
from mien.vocabulary.fapu import Fapu, measure

NEEDED = (CHIN, *LIPS, *OUTER_LIPS, "9.15")
"""Points without which a face cannot be driven by FAPs."""
LIDS = (19, 20, 21, 22)
"""FAPs of the upper lids, left and right, then the lower."""
CORNERS = ((6, 53), (7, 54))
"""FAPs that stretch the left and the right corner of the mouth: inner, then outer edge."""


@dataclass(frozen=True, slots=True, eq=False)
class FapBasis:
    """The fields of one face."""

    fapu: Fapu
    size: Array
    """(66,) mm, or radians, of a value of 1."""
    fields: NDArray[np.float32]
    """(66, V, 3) mm at a value of 1; zero for what turns, and what the face has no point for."""
    slides: NDArray[np.float32]
    """(6, V, 3) mm that each of LIDS is carried round the eyeball half-way, and that each of
    CORNERS goes back along the arch of the lips when it is stretched as far as it goes."""
    closed: float
    """Value at which the lips' inner edges have met."""


def fap_basis(face: Face) -> FapBasis:
    """Work out the basis of ``face``: a second. Raises InputError where it lacks points
    or is in pieces."""
    missing = [fdp for fdp in NEEDED if fdp not in face.points.ids]
    if missing:
        raise InputError(
            f"{len(missing)} feature points without which FAPs cannot drive a face are missing: "
            + ", ".join(missing)
        )
    face, stands_for = sewn_up(face)
    fapu = measure(face.points.ids, face.points.at(face.vertices))
    part = skin_of(face)
    held, eyes = _lids(face, part)
    body = skin(face, part, held)
    fields = np.zeros((len(simple()), *face.vertices.shape))
    for (fdp, axis), influence in body.maps.items():
        for number in _along(fdp, axis):
            fields[column(number), :, axis] = faps()[number].sign * influence
    _move_jaw(face, body, fields)
    _move_tongue(face, fields)
    _move_ears(face, body.part, fields)
    _move_eyes(face, fapu, fields)
    size = np.array([fap.size(fapu) for fap in simple()])
    fields *= np.nan_to_num(size)[:, None, None]
    for number in LIDS:
        if number in eyes:
            fields[column(number)] = eyes[number][0] / PER_UNIT
    still = np.zeros_like(face.vertices)
    slides = [eyes[number][1] if number in eyes else still for number in LIDS]
    slides += [_along_the_arch(face, fields, edges) for edges in CORNERS]
    everything = np.concatenate([fields, slides])
    fap_parts.cling(face, everything, body.part)
    everything = everything[:, stands_for].astype(np.float32)
    gap = max(float(face.point("2.2")[1] - face.point("2.3")[1]), 0.0)
    return FapBasis(
        fapu=fapu,
        size=size,
        fields=everything[: len(fields)],
        slides=everything[len(fields) :],
        closed=float(np.nan_to_num(gap / fapu.philtrum * PER_UNIT)),
    )


def _along_the_arch(face: Face, fields: Array, edges: tuple[int, int]) -> Array:
    """(V, 3) mm forwards or back, at the stretch of a corner that is the farthest: lips lie on an
    arch through their middle and corners."""
    middle, left, right = (face.point(fdp) for fdp in ("2.2", "2.4", "2.5"))
    half = (left[0] - right[0]) / 2.0
    bend = (middle[2] - (left[2] + right[2]) / 2.0) / half**2
    aside = sum(faps()[number].reach * fields[column(number), :, 0] for number in edges)
    back = np.zeros_like(face.vertices)
    back[:, 2] = -2.0 * bend * face.vertices[:, 0] * aside
    return back


def _along(fdp: str, axis: int) -> list[int]:
    return [fap.number for fap in simple() if fap.point == fdp and fap.axis == axis]


def _lids(face: Face, part: Part) -> tuple[Mask, dict[int, tuple[Array, Array]]]:
    """(V,) skin that only the lids move, and motion and slide (V, 3) of each lid's FAP."""
    held = np.zeros(len(face.vertices), dtype=bool)
    found = {}
    for side, (upper_fap, lower_fap) in enumerate(((19, 21), (20, 22))):
        both = lids(face, part, side)
        if both is None:
            continue
        held |= both.area
        found[upper_fap] = both.upper.motion, both.upper.slide
        found[lower_fap] = both.lower.motion, both.lower.slide
    return held, found


def _move_jaw(face: Face, body: Skin, fields: Array) -> None:
    """Skin goes where the chin goes; bone turns; the mouth's lining hangs between lips and bone."""
    motion = fap_parts.jaw_motion(face, face.point(CHIN))
    carried = fap_parts.on_lower_jaw(face)
    bone = np.zeros_like(fields)
    for axis in range(3):
        for number in _along(CHIN, axis):
            moved = faps()[number].sign * motion[axis]
            bone[column(number)] = moved
            fields[column(number), :, axis] = body.jaw[axis] * moved[:, axis]
            fields[column(number), carried] = moved[carried]
    hang_lining(face, body.mouth, body.lining, fields, bone)


def _move_tongue(face: Face, fields: Array) -> None:
    found = fap_parts.tongue(face)
    if found is None:
        return
    part, surface = found
    mine = rows(face, part)
    for fap in simple():
        if fap.group != 6:
            continue
        if fap.axis is None:
            fields[column(fap.number), mine] = fap_parts.curl(face, part)[mine]
            continue
        zero = [o.point for o in simple() if o.group == 6 and o.axis == fap.axis]
        influence = surface.map([fap.point], [fdp for fdp in zero if fdp != fap.point])
        fields[column(fap.number), mine, fap.axis] = fap.sign * influence[mine]


def _move_ears(face: Face, skin_part: Mask, fields: Array) -> None:
    for surface in fap_parts.ears(face, skin_part):
        for fap in simple():
            if fap.group == 10 and fap.point in surface.ids and fap.axis is not None:
                influence = surface.map([fap.point], [])
                fields[column(fap.number), :, fap.axis] += fap.sign * influence


def _move_eyes(face: Face, fapu: Fapu, fields: Array) -> None:
    for side, (thrust, widen) in enumerate(((27, 29), (28, 30))):
        fields[column(thrust), fap_parts.eyeball(face, side), 2] = 1.0
        if np.isfinite(fapu.iris):
            fields[column(widen)] = fap_parts.widened_pupil(face, side, fapu.iris)
