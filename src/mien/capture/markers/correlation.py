"""How the markers of one face move together: a Gaussian over all of them, learnt from the take.

What one marker does can be told from the others within half a millimetre, for faces have far
fewer ways to move than markers. It fills gaps (``gaps``) and tells who is who (``mend``).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_ENOUGH = 2000
"""Frames to learn from; of longer takes so many are taken, evenly."""
_ROUNDS = 12
_SETTLED = 1e-3
"""mm, change of the guesses at which learning ends."""


@dataclass(frozen=True, slots=True)
class Correlation:
    """A Gaussian over the places of M markers."""

    mean: Array
    """(M, 3) mm."""
    covariance: Array
    """(3 M, 3 M) mm², noise included."""

    def predict(self, places: Array, known: Mask) -> tuple[Array, Array]:
        """The likeliest places (F, M, 3) of all markers given the ``known`` (F, M) of ``places``
        (F, M, 3), which stay as they are, and standard errors (F, M) of a coordinate of those
        that were not known (0 where known)."""
        guess = np.where(known[..., None], places, 0.0)
        error = np.zeros(known.shape)
        for pattern, frames in _patterns(known):
            if pattern.all():
                continue
            _, gain, variance = self._given(pattern)
            moved = (places[frames] - self.mean)[:, pattern].reshape(len(frames), -1)
            hidden = (moved @ gain).reshape(len(frames), -1, 3) + self.mean[~pattern]
            guess[np.ix_(frames, np.flatnonzero(~pattern))] = hidden
            error[np.ix_(frames, np.flatnonzero(~pattern))] = np.sqrt(
                np.diag(variance).reshape(-1, 3).mean(axis=1)
            )
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
            # What all others tell of one follows from the inverse covariance, block by block.
            precision = np.linalg.inv(self.covariance[np.ix_(there, there)])
            moved = (places[frames] - self.mean)[:, pattern].reshape(len(frames), -1)
            pulled = (moved @ precision).reshape(len(frames), -1, 3)
            blocks = precision.reshape(len(pulled[0]), 3, len(pulled[0]), 3)
            own = np.einsum("mxmy->mxy", blocks)
            told = np.linalg.solve(own[None], pulled[..., None])[..., 0]
            apart[np.ix_(frames, np.flatnonzero(pattern))] = told
        return np.asarray(np.linalg.norm(apart, axis=-1))

    def _given(self, pattern: Mask) -> tuple[Mask, Array, Array]:
        """Which coordinates are known, the gain (known, hidden) and the covariance of the hidden
        ones, under a ``pattern`` (M,) of known markers."""
        there = np.repeat(pattern, 3)
        across = self.covariance[np.ix_(there, ~there)]
        if not there.any():
            return there, across, self.covariance
        factor = cho_factor(self.covariance[np.ix_(there, there)])
        gain = cho_solve(factor, across)
        return there, gain, self.covariance[np.ix_(~there, ~there)] - across.T @ gain


def learn(places: Array, known: Mask, noise: float) -> Correlation:
    """The correlation of markers at ``places`` (F, M, 3) where ``known`` (F, M), by expectation
    and maximisation over what is missing; ``noise`` is the standard error of a coordinate, mm.

    A marker that is never known stays with the middle of the others. Raises ValueError where
    nothing is known at all.
    """
    chosen = np.unique(np.linspace(0, len(places) - 1, _ENOUGH).astype(int))
    places, known = places[chosen], known[chosen]
    if not known.any():
        raise ValueError("no marker was seen")
    count = places.shape[1]
    held = np.where(known[..., None], places, np.nan)
    with np.errstate(invalid="ignore"):
        sums = np.where(known[..., None], places, 0.0).sum(axis=0)
    times = known.sum(axis=0)[:, None]
    mean = np.where(times > 0, sums / np.maximum(times, 1), np.nanmean(held))
    moved = np.where(known[..., None], places - mean, 0.0).reshape(len(places), -1)
    model = Correlation(mean, _firm(moved.T @ moved / len(places), noise))
    before = places
    for _ in range(_ROUNDS):
        guess, _ = model.predict(places, known)
        extra = np.zeros((3 * count, 3 * count))
        for pattern, frames in _patterns(known):
            if not pattern.all():
                there, _, variance = model._given(pattern)
                extra[np.ix_(~there, ~there)] += len(frames) * variance
        mean = guess.mean(axis=0)
        moved = (guess - mean).reshape(len(guess), -1)
        model = Correlation(mean, _firm((moved.T @ moved + extra) / len(guess), noise))
        if np.abs(guess - before)[~known].max(initial=0.0) < _SETTLED:
            break
        before = guess
    return model


def _firm(covariance: Array, noise: float) -> Array:
    return covariance + max(noise, 0.01) ** 2 * np.eye(len(covariance))


def _patterns(known: Mask) -> list[tuple[Mask, NDArray[np.intp]]]:
    """Each set of markers that are known together, and the frames in which they are."""
    kinds, which = np.unique(known, axis=0, return_inverse=True)
    order = np.argsort(which.ravel(), kind="stable")
    ends = np.cumsum(np.bincount(which.ravel(), minlength=len(kinds)))
    return list(zip(kinds, np.split(order, ends[:-1]), strict=True))
