"""What a feature is expected to be, as a quadratic form in the twelve numbers of its lens.

The prior of a lens x is sum w |A x - A x0|^2 over its parts; together x' Q x - 2 b' x.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_CORNERS = 0.002
"""Per squared patch unit: an eye's corners stay where the turned head has them. Any firmer, and
the head, which is turned by the corners, never turns."""
_STRANGE_CORNERS = 0.006
"""The same before the performer is known, while nothing turns: paint beside the eye pulls less."""
_LIDS = 0.0007
"""Lids stay where they were."""
_BROW_SHAPE, _BROW_THICKNESS = 0.0015, 0.004
"""A brow keeps its shape but for its place, and its thickness."""
_BROW_ALONG, _STRANGE_ALONG = 0.001, 0.003
"""Its ends fade into the skin: they are where they are at rest, across the face; the more so
before the performer is known."""
_STRANGER = 0.1
"""How much less the shape of everybody's brow is trusted than the performer's own."""
_NOSTRIL_SHAPE, _NOSTRIL_PLACE = 0.002, 0.002
"""A nostril keeps its shape, and its place on a nose that hardly moves."""
_LIPS = 0.00004
"""Lips stay where they were, but hardly: a mouth opens within a few frames."""
_LIP_CORNERS = 0.002
"""The mouth's corners stay about as far up between the lips as they are at rest."""
_EVENNESS = 0.0005
"""The two halves of brows, lids and lips differ as they do at rest: what is dark below one half of
a brow is shadow or paint, and would take the brow's edge with it."""


def _pick(points: list[int]) -> Array:
    rows = [2 * point + axis for point in points for axis in (0, 1)]
    return np.eye(12)[rows]


_ENDS, _MIDDLES, _WHOLE = _pick([0, 1]), _pick([2, 3, 4, 5]), np.eye(12)
_LIFTED = np.kron(np.array([[0.5, 0.5, -0.25, -0.25, -0.25, -0.25]]), np.array([[0.0, 1.0]]))
_ALONG = np.eye(12)[[0, 2]]
_THICKNESS = _pick([4, 5]) - _pick([2, 3])
_PLACE = np.kron(np.full((1, 6), 1.0 / 6.0), np.eye(2))
_SHAPE = np.eye(12) - np.kron(np.full((6, 6), 1.0 / 6.0), np.eye(2))


def _evenness() -> Array:
    """(4, 12) how unlike the two middle points of a curve lie to their ends: upper and lower
    curve, along and across."""
    rows = np.zeros((4, 6, 2))
    for curve, (left, right) in enumerate(((2, 3), (4, 5))):
        rows[2 * curve, [left, right, 0, 1], 0] = 1.0, 1.0, -1.0, -1.0
        rows[2 * curve + 1, [left, right, 0, 1], 1] = 1.0, -1.0, -1.0, 1.0
    return rows.reshape(4, 12)


_EVEN = _evenness()


def prior(group: str, rest: Array, last: Array, known: bool) -> tuple[Array, Array]:
    """Q (12, 12) and b (12,) of a feature of ``group`` that looks like ``rest`` (6, 2) at rest
    and was ``last`` (6, 2) in the frame before; ``known`` says that ``rest`` is the performer's
    own."""
    quadratic, to_rest, to_last = _squares(group, known)
    return quadratic, to_rest @ rest.reshape(12) + to_last @ last.reshape(12)


@cache
def _squares(group: str, known: bool) -> tuple[Array, Array, Array]:
    """(12, 12) each: Q, and its shares that pull to rest and to the last place."""
    if group == "eye":
        corners = _CORNERS if known else _STRANGE_CORNERS
        to_rest = _square(corners, _ENDS) + _square(_EVENNESS, _EVEN)
        to_last = _square(_LIDS, _MIDDLES)
    elif group == "brow":
        trust = 1.0 if known else _STRANGER
        shape = _square(trust * _BROW_SHAPE, _SHAPE)
        thickness = _square(trust * _BROW_THICKNESS, _THICKNESS)
        along = _square(_BROW_ALONG if known else _STRANGE_ALONG, _ALONG)
        to_rest = shape + thickness + along + _square(_EVENNESS, _EVEN)
        to_last = np.zeros((12, 12))
    elif group == "nostril":
        place = _NOSTRIL_PLACE * (1.0 if known else 0.5)
        to_rest = _square(_NOSTRIL_SHAPE, _SHAPE) + _square(place, _PLACE)
        to_last = np.zeros((12, 12))
    else:
        to_rest = _square(_EVENNESS, _EVEN) + _square(_LIP_CORNERS, _LIFTED)
        to_last = _square(_LIPS, _WHOLE)
    return to_rest + to_last, to_rest, to_last


def _square(weight: float, pick: Array) -> Array:
    return np.asarray(weight * pick.T @ pick)
