"""The quadratic programme of one frame: motion, the cardinal pull and the bounds, jointly.

    min_w  sum_qx ((A w - m)_qx / sigma_qx)^2 + coupling |w - cardinal(m)|^2
           + balance sum (w_left - w_right)^2 + kinship sum (w - mean w)^2
           + ridge |w|^2 + 2 thrift sum w_i / e_i,     0 <= w <= bound

A the pieces' motion and m the performer's, both without what the camera could not see; q runs
over feature points and spans; e_i is the standard error of w_i alone, from the points in full
view. (Spans may be so sure that what opens the lips would hardly have to pay.)
"""

from __future__ import annotations

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.face.pieces import Pieces
from mien.mapping.regional import RegionalCardinal
from mien.mapping.settings import Settings
from mien.mapping.sight import Sight, seen
from mien.numeric.positive import solve_positive
from mien.numeric.qp import solve_boxes

Array = NDArray[np.float64]

_TURN = np.radians(25.0)
"""A turned head is measured worse: rows count by 1 / (1 + (turn / this)^2)."""
_FIRM = 1e-9
"""Part of the largest curvature that is added to all, so that the minimum is always unique."""


class Programme:
    """Solves for the weights of W pieces, frame by frame."""

    def __init__(
        self,
        fields: Array,
        precision: Array,
        points: int,
        pieces: Pieces,
        cardinal: RegionalCardinal,
        settings: Settings,
    ) -> None:
        """``fields`` (W, Q, 3) motion of each piece, ``precision`` (Q, 3), the first ``points``
        rows feature points, the others spans."""
        self._fields = fields
        self._sight = Sight(fields, precision)
        self._cardinal = cardinal
        self._settings = settings
        certainty = np.sqrt((fields**2 * precision)[:, :points].sum(axis=(1, 2)))
        self._threshold = settings.thrift * certainty
        pull = settings.balance * _pull_together(pieces.key, pieces.region)
        pull += settings.kinship * _pull_together(pieces.key, pieces.side)
        self._prior = pull + (settings.ridge + settings.coupling) * np.eye(len(fields))
        self._bounds = np.zeros(len(fields)), np.full(len(fields), settings.largest)

    def solve(self, motion: Array, unseen: Array) -> Array:
        """Weights (F, W) of all pieces for ``motion`` (F, Q, 3) mm, of which nothing is known
        along ``unseen`` (F, 3)."""
        alike = bool((unseen == unseen[:1]).all())
        sight = seen(unseen)
        gram = self._sight.gram(sight[:1] if alike else sight)
        onto = self._sight.onto(motion, sight)
        belief = _belief(unseen)
        linear = self._threshold - onto * belief[:, None]
        if self._settings.coupling:
            whole = self._fill(motion, unseen, sight, gram, onto)
            linear -= self._settings.coupling * self._cardinal(whole)
        hessian = gram * belief[: len(gram), None, None] + self._prior
        _add_to_diagonals(hessian, _FIRM * hessian.max(axis=(1, 2)))
        return solve_boxes(hessian, linear, *self._bounds)

    def _fill(self, motion: Array, unseen: Array, sight: Array, gram: Array, onto: Array) -> Array:
        """``motion`` with its unseen part as the pieces that explain the seen part would have
        it, by ridge least squares: the cardinal functions need all three coordinates."""
        if not unseen.any():
            return motion
        stiff = gram.copy()
        ridge = max(self._settings.linear_ridge, _FIRM * float(gram.max()))
        _add_to_diagonals(stiff, np.full(len(gram), ridge))
        weights = solve_positive(stiff, onto)
        guess = (weights @ self._fields.reshape(len(self._fields), -1)).reshape(motion.shape)
        depth = (guess * unseen[:, None]).sum(axis=-1, keepdims=True)
        return np.asarray(motion @ sight + depth * unseen[:, None])


@njit(cache=True, nogil=True)
def _add_to_diagonals(matrices: Array, amount: Array) -> None:
    """Add ``amount`` (U,) to the diagonals of ``matrices`` (U, W, W), in place."""
    for u in range(len(matrices)):
        for i in range(matrices.shape[1]):
            matrices[u, i, i] += amount[u]


@njit(cache=True, nogil=True)
def _belief(unseen: Array) -> Array:
    """(F,) how far the rows of a frame count, from the turn between the camera and the face."""
    belief = np.ones(len(unseen))
    for f in range(len(unseen)):
        if unseen[f].any():
            turn = np.arccos(min(abs(unseen[f, 2]), 1.0))
            belief[f] = 1.0 / (1.0 + (turn / _TURN) ** 2)
    return belief


def _pull_together(key: NDArray[np.intp], group: NDArray[np.intp]) -> Array:
    """(W, W) quadratic form of sum (w - mean w)^2 over the pieces of each key and group."""
    kin = ((key[:, None] == key) & (group[:, None] == group)).astype(float)
    return np.asarray(np.eye(len(key)) - kin / kin.sum(axis=1, keepdims=True))
