"""Cardinal weights of pieces: one set of cardinal functions for each region and side.

A region's parameter vector is the performer's whitened motion times the region's mask at each
feature point, and its examples are the full key models under the same mask. So a key model shown
whole gives one in every region and a brow raised alone gives a brow alone.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from mien.face.pieces import Pieces
from mien.mapping.cardinal import CardinalFunctions, fit
from mien.mapping.examples import Examples
from mien.mapping.sight import Rows
from mien.numeric.bspline import cubic

Array = NDArray[np.float64]

_NOTHING = 1e-6
"""Whitened motion below this is none: its key model is at rest in that region."""


class RegionalCardinal:
    """Weights (F, W) of all pieces from motion (F, Q, 3) of the compared rows, mm."""

    def __init__(
        self,
        examples: Examples,
        pieces: Pieces,
        rows: Rows,
        ridge: float,
        threshold: float = 0.0,
    ) -> None:
        """``ridge`` and ``threshold`` as in ``cardinal.fit``."""
        count = len(examples.owner)
        found: list[tuple[Array, CardinalFunctions]] = []
        motion = rows(examples.keys)
        weight = np.sqrt(rows.precision)
        share = np.zeros(count)
        for region, side in np.ndindex(*examples.masks.shape[:2]):
            driven = (pieces.region == region) & ((pieces.side == side) | (pieces.side < 0))
            mask = rows.mask(examples.masks[region, side])
            whitener = (mask[:, None] * weight).ravel()
            places = motion.reshape(len(motion), -1) * whitener
            shown = np.linalg.norm(places, axis=1) > _NOTHING
            targets = np.zeros((len(motion), count))
            targets[examples.owner[driven], np.flatnonzero(driven)] = 1.0
            if not (shown[:, None] & (targets > 0)).any():
                continue
            found.append((whitener, fit(places[shown], targets[shown], ridge, threshold)))
            share += targets[shown].sum(axis=0)
        self._stack(found, motion[0].size, count)
        # A piece that is not split has a weight from either side: their mean.
        self._linear /= np.maximum(share, 1.0)
        self._radial /= np.maximum(share, 1.0)

    def _stack(
        self, found: Sequence[tuple[Array, CardinalFunctions]], coordinates: int, count: int
    ) -> None:
        """All regions as one: places beside each other, examples below each other, so that a frame
        takes a few products. |p - p_j|^2 is a product too: B has no kink at 0 to lose it in."""
        nothing = np.zeros((0, coordinates))
        each = [functions for _, functions in found]
        features = [functions.feature * whitener for whitener, functions in found]
        self._feature = np.concatenate([nothing, *features])
        self._linear = np.concatenate([np.zeros((0, count)), *(f.linear for f in each)])
        self._radial = np.concatenate([np.zeros((0, count)), *(f.radial for f in each)])
        places = block_diag(np.zeros((0, 0)), *(f.places / f.dilation[:, None] for f in each))
        ones = [np.repeat(f.dilation[:, None] ** -2.0, f.places.shape[1], axis=1) for f in each]
        dilation = np.concatenate([np.zeros(0), *(f.dilation for f in each)])
        self._onto = (2.0 * places / dilation[:, None]).T
        self._own = block_diag(np.zeros((0, 0)), *ones).T
        self._square = (places**2).sum(axis=1)

    def __call__(self, motion: Array) -> Array:
        place = motion.reshape(len(motion), -1) @ self._feature.T
        square = (place**2) @ self._own - place @ self._onto + self._square
        bells = cubic(np.sqrt(np.maximum(square, 0.0)))
        return np.asarray(place @ self._linear + bells @ self._radial)
