"""What can be compared, and how well: feature points and spans, as one camera saw them.

A camera has no depth: along ``unseen``, which turns with the head from frame to frame, neither
performer nor example counts. With P = 1 - u u' the inner product of two motions a and b is
sum_qx precision_qx (P a)_qx (P b)_qx, and that of two fixed motions is a sum of products of P's
entries with tensors that do not change: the Gram matrix of a frame costs a few additions.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.performance.performance import Performance

Array = NDArray[np.float64]
Index = NDArray[np.intp]

_PAIRS = tuple((y, z) for y in range(3) for z in range(y, 3))
_FIRST, _SECOND = (list(axes) for axes in zip(*_PAIRS, strict=True))


@dataclass(frozen=True, slots=True)
class Rows:
    """P points and S spans; a span is one more point that moves by the difference of two and is
    known along one axis."""

    points: Index
    """(P,) rows of the performance."""
    first: Index
    second: Index
    """(S,) each, into the P points."""
    precision: Array
    """(P + S, 3) one over the squared standard error; 0 where unknown."""

    def __call__(self, motion: Array) -> Array:
        """(..., P + S, 3) of motion (..., P, 3) of the P points."""
        spans = motion[..., self.first, :] - motion[..., self.second, :]
        return np.concatenate([motion, spans], axis=-2)

    def mask(self, share: Array) -> Array:
        """(P + S,) of a mask (P,) on the points; a span has the mean of its two."""
        return np.concatenate([share, (share[self.first] + share[self.second]) / 2.0])


def compare(performance: Performance, points: Sequence[str]) -> Rows:
    """The rows of a performance on ``points`` (a subset of its own)."""
    row = {fdp: i for i, fdp in enumerate(performance.points)}
    place = {fdp: i for i, fdp in enumerate(points)}
    spans = [s for s in performance.spans if s.first in place and s.second in place]
    index = np.array([row[fdp] for fdp in points], dtype=np.intp)
    sigma = np.full((len(points) + len(spans), 3), np.inf)
    sigma[: len(points)] = performance.sigma[index]
    for i, span in enumerate(spans, start=len(points)):
        sigma[i, span.axis] = span.sigma
    if not (sigma > 0).all():
        raise ValueError("sigma must be positive (infinite where a coordinate is unknown)")
    return Rows(
        points=index,
        first=np.array([place[s.first] for s in spans], dtype=np.intp),
        second=np.array([place[s.second] for s in spans], dtype=np.intp),
        precision=sigma**-2.0,
    )


def seen(unseen: Array) -> Array:
    """Projections (F, 3, 3) on what is seen, from directions (F, 3) that are unit or zero."""
    return np.asarray(np.eye(3) - unseen[:, :, None] * unseen[:, None, :])


class Sight:
    """Inner products with W fixed motions, as seen."""

    def __init__(self, motions: Array, precision: Array) -> None:
        """``motions`` (W, Q, 3), ``precision`` (Q, 3)."""
        self.count = len(motions)
        self._precision = precision
        self._motions = np.ascontiguousarray(motions.reshape(self.count, -1))
        grams = np.einsum("wqy,qx,vqz->xyzwv", motions, precision, motions, optimize=True)
        grams += np.swapaxes(grams, 1, 2)
        terms = [grams[x, y, z] / (2.0 if y == z else 1.0) for x in range(3) for y, z in _PAIRS]
        below = np.tril_indices(self.count)
        self._grams = np.stack([term[below] for term in terms], axis=1)

    def gram(self, sight: Array) -> Array:
        """(F, W, W) inner products among the motions under projections ``sight`` (F, 3, 3)."""
        factors = sight[:, :, _FIRST] * sight[:, :, _SECOND]
        return _summed(factors.reshape(len(sight), -1), self._grams, self.count)

    def onto(self, motion: Array, sight: Array) -> Array:
        """(F, W) inner products of ``motion`` (F, Q, 3) with each of the motions."""
        weighed = ((motion @ sight) * self._precision) @ sight
        return np.asarray(weighed.reshape(len(motion), -1) @ self._motions.T)


@njit(cache=True, nogil=True, fastmath={"reassoc"})
def _summed(factors: Array, terms: Array, count: int) -> Array:
    """(F, W, W) symmetric matrices, whose lower halves are ``terms`` (W (W + 1) / 2, T) summed with
    ``factors`` (F, T). In a frame of live work the terms come out of slow memory: each comes once.
    """
    sums = np.empty((len(factors), count, count))
    for f in range(len(factors)):
        place = 0
        for i in range(count):
            for j in range(i + 1):
                total = 0.0
                for t in range(terms.shape[1]):
                    total += factors[f, t] * terms[place, t]
                sums[f, i, j] = sums[f, j, i] = total
                place += 1
    return sums
