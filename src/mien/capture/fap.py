"""MPEG-4 animation parameters become a Performance, and their values motion of feature points."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from mien.errors import InputError
from mien.face.character import Character
from mien.face.fap_targets import basis_of
from mien.formats.takes.fap import FapTake
from mien.performance.performance import Performance
from mien.vocabulary.fap import (
    FIRST,
    PER_UNIT,
    Array,
    column,
    expression_values,
    head_and_gaze,
    names,
    viseme_values,
)

_SIGMA = 0.5
"""mm; values are smooth, and it is our own face that stands between."""
_LIPS = tuple(zip((4, 5, 6, 7, 8, 9, 10, 11, 12, 13), range(51, 61), strict=True))
"""FAPs of the inner edge of the lips and of the outer edge, which have the same units."""
_LIDS = {"lid_left": (19, 21), "lid_right": (20, 22)}


def perform(take: FapTake, source: str) -> Performance:
    """What a take says, as values of the vocabulary "fap", with head and gaze; it has no points.

    Visemes and expressions become values of the simple FAPs and add to those; where one is a
    definition (viseme_def, expression_def) the simple values say it all. A take that never gives
    one edge of the lips has it follow the other, or the lips would turn inside out.
    """
    values = take.values[:, FIRST - 1 :].copy()
    _mend_lips(values, np.any(take.mask[:, FIRST - 1 :], axis=0))
    blend, defined = take.viseme[:, 2], take.viseme[:, 3] != 0
    first, second = take.viseme[:, :2].astype(int).T
    values += np.where(defined[:, None], 0.0, viseme_values(first, second, blend))
    defined = take.expression[:, 5] != 0
    one, two = take.expression[:, [0, 2]].astype(int).T
    shown = expression_values(one, take.expression[:, 1], two, take.expression[:, 3])
    values += np.where(defined[:, None], 0.0, shown)
    rotation, gaze = head_and_gaze(values)
    frames = len(values)
    return Performance(
        points=(),
        neutral=np.zeros((0, 3)),
        time=(take.number - take.number[0]) / take.rate,
        motion=np.zeros((frames, 0, 3)),
        sigma=np.zeros((0, 3)),
        rotation=rotation,
        translation=np.zeros((frames, 3)),
        gaze=gaze,
        confidence=np.ones(frames),
        lost=np.zeros(frames, dtype=bool),
        unseen=np.zeros((frames, 3)),
        vocabulary="fap",
        shapes=values,
        source=source,
    )


def motion_from_faps(performance: Performance, generic: Character) -> Performance:
    """``performance`` with the motion of feature points that its FAP values stand for.

    The performer becomes the generic face: (F, P, 3) motion is the weighted sum of its FAP basis
    at its feature points ([C] eq. 2); lids close by the sum of either lid's way.
    Raises InputError where the values are not 66 a frame.
    """
    basis, face, values = basis_of(generic), generic.face, performance.shapes
    if values.shape[1] != len(names()):
        raise InputError(
            f"{performance.source}: {values.shape[1]} FAPs, expected {len(names())} (3 to 68)"
        )
    points = face.points.ids
    lids = {
        name: values[:, [column(upper), column(lower)]].sum(axis=1) / PER_UNIT
        for name, (upper, lower) in _LIDS.items()
    }
    return replace(
        performance,
        points=points,
        neutral=face.points.at(face.vertices),
        motion=np.tensordot(values, face.points.at(basis.fields), axes=1),
        sigma=np.full((len(points), 3), _SIGMA),
        unseen=np.zeros((len(performance), 3)),
        scalars={**performance.scalars, **lids},
    )


def _mend_lips(values: Array, given: NDArray[np.bool_]) -> None:
    inner, outer = ([column(pair[edge]) for pair in _LIPS] for edge in (0, 1))
    if not given[outer].any():
        values[:, outer] = values[:, inner]
    elif not given[inner].any():
        values[:, inner] = values[:, outer]
