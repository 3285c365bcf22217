"""How the markers of one face move together: a Gaussian over all of them, learnt from the take.

What one marker does can be told from the others within half a millimetre, for faces have far
fewer ways to move than markers. It fills gaps (``gaps``) and tells who is who (``mend``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_ENOUGH = 2000
"""Frames to learn from; of longer takes so many are taken, evenly."""
_ROUNDS = 12
_SETTLED = 0.01
"""mm, change of the guesses at which learning ends."""


@dataclass(frozen=True, slots=True)
class Correlation:
    """A Gaussian over the places of M markers."""

    mean: Array
    """(M, 3) mm."""
    precision: Array
    """(3 M, 3 M) the inverse of the covariance, noise included: what is hidden follows from the
    block of the few that are, and not from the many that are known."""

    def predict(self, places: Array, known: Mask) -> tuple[Array, Array]:
        """The likeliest places (F, M, 3) of all markers given the ``known`` (F, M) of ``places``
        (F, M, 3), which stay as they are, and standard errors (F, M) of a coordinate of those
        that were not known (0 where known)."""
        guess = np.where(known[..., None], places, 0.0)
        error = np.zeros(known.shape)
        for pattern, frames in _patterns(known):
            if not pattern.all():
                hidden = np.ix_(frames, np.flatnonzero(~pattern))
                guess[hidden], covariance = self._hidden(places[frames], pattern)
                error[hidden] = np.sqrt(np.diag(covariance).reshape(-1, 3).mean(axis=1))
        return guess, error

    def surprise(self, places: Array, known: Mask) -> Array:
        """(F, M) mm, how far each marker of ``places`` (F, M, 3) is from where the other
        ``known`` ones (F, M) tell it to be; NaN where it has no place."""
        guess, _ = self.predict(places, known)
        apart = np.where(known[..., None], 0.0, places - guess)
        for pattern, frames in _patterns(known):
            there = np.repeat(pattern, 3)
            if not there.any():
                continue
            across = self.precision[np.ix_(there, ~there)]
            within = self.precision[np.ix_(~there, ~there)]
            # What all others tell of one follows from the precision of those known, by blocks.
            precision = self.precision[np.ix_(there, there)]
            precision = precision - across @ np.linalg.solve(within, across.T)
            moved = (places[frames] - self.mean)[:, pattern].reshape(len(frames), -1)
            pulled = (moved @ precision).reshape(len(frames), -1, 3)
            own = np.einsum("mxmy->mxy", precision.reshape(2 * (pulled.shape[1], 3)))
            told = np.einsum("mxy,fmy->fmx", np.linalg.inv(own), pulled)
            apart[np.ix_(frames, np.flatnonzero(pattern))] = told
        return np.asarray(np.linalg.norm(apart, axis=-1))

    def _hidden(self, places: Array, pattern: Mask) -> tuple[Array, Array]:
        """Likeliest places (F, H, 3) and covariance (3 H, 3 H) of the H markers that a ``pattern``
        (M,) of known ones hides."""
        there = np.repeat(pattern, 3)
        covariance: Array = np.linalg.inv(self.precision[np.ix_(~there, ~there)]).astype(float)
        moved = (places - self.mean)[:, pattern].reshape(len(places), -1)
        pulled = moved @ self.precision[np.ix_(there, ~there)] @ covariance
        return self.mean[~pattern] - pulled.reshape(len(places), -1, 3), covariance


def learn(places: Array, known: Mask, noise: float) -> Correlation:
    """The correlation of markers at ``places`` (F, M, 3) where ``known`` (F, M), by expectation
    and maximisation over what is missing; ``noise`` is the standard error of a coordinate, mm.

    Every marker must be known somewhere, or stays with the middle of the others. Raises ValueError
    where nothing is known at all.
    """
    chosen = np.unique(np.linspace(0, len(places) - 1, _ENOUGH).astype(int))
    places, known = places[chosen], known[chosen]
    if not known.any():
        raise ValueError("no marker was seen")
    held = np.where(known[..., None], places, 0.0)
    times = known.sum(axis=0)[:, None]
    middle = held.sum(axis=(0, 1)) / known.sum()
    mean = np.where(times > 0, held.sum(axis=0) / np.maximum(times, 1), middle)
    guess = np.where(known[..., None], places, mean)
    extra = np.zeros((mean.size, mean.size))
    for _ in range(_ROUNDS):
        before = guess
        mean = guess.mean(axis=0)
        moved = (guess - mean).reshape(len(guess), -1)
        covariance = (moved.T @ moved + extra) / len(guess)
        covariance = covariance + max(noise, 0.01) ** 2 * np.eye(len(covariance))
        model = Correlation(mean, np.linalg.inv(covariance))
        guess, extra = _expect(model, places, known)
        if np.abs(guess - before).max() < _SETTLED:
            break
    return model


def _expect(model: Correlation, places: Array, known: Mask) -> tuple[Array, Array]:
    """``places`` with the hidden ones as ``model`` has them, and the sum over frames of the
    covariance that is left of them (3 M, 3 M)."""
    guess = np.where(known[..., None], places, 0.0)
    extra = np.zeros_like(model.precision)
    for pattern, frames in _patterns(known):
        if not pattern.all():
            there = np.repeat(pattern, 3)
            told, covariance = model._hidden(places[frames], pattern)
            guess[np.ix_(frames, np.flatnonzero(~pattern))] = told
            extra[np.ix_(~there, ~there)] += len(frames) * covariance
    return guess, extra


def _patterns(known: Mask) -> list[tuple[Mask, NDArray[np.intp]]]:
    """Each set of markers that are known together, and the frames in which they are."""
    kinds, which = np.unique(known, axis=0, return_inverse=True)
    order = np.argsort(which.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(which.ravel(), minlength=len(kinds)))
    return list(zip(kinds, np.split(order, ends[:-1]), strict=True))
