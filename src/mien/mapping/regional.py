"""Cardinal weights of pieces: one set of cardinal functions for each region and side.

A region's parameter vector is the performer's whitened motion times the region's mask at each
feature point, and its examples are the full key models under the same mask. So a key model shown
whole gives one in every region and a brow raised alone gives a brow alone.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.face.pieces import Pieces
from mien.mapping.cardinal import CardinalFunctions, fit
from mien.mapping.examples import Examples
from mien.mapping.sight import Rows

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
        self._count = len(examples.owner)
        self._regions: list[tuple[Array, CardinalFunctions]] = []
        motion = rows(examples.keys)
        weight = np.sqrt(rows.precision)
        share = np.zeros(self._count)
        for region, side in np.ndindex(*examples.masks.shape[:2]):
            driven = (pieces.region == region) & ((pieces.side == side) | (pieces.side < 0))
            mask = rows.mask(examples.masks[region, side])
            whitener = (mask[:, None] * weight).ravel()
            places = motion.reshape(len(motion), -1) * whitener
            shown = np.linalg.norm(places, axis=1) > _NOTHING
            targets = np.zeros((len(motion), self._count))
            targets[examples.owner[driven], np.flatnonzero(driven)] = 1.0
            if not (shown[:, None] & (targets > 0)).any():
                continue
            functions = fit(places[shown], targets[shown], ridge, threshold)
            share += targets[shown].sum(axis=0)
            self._regions.append((whitener, functions))
        self._share = np.maximum(share, 1.0)

    def __call__(self, motion: Array) -> Array:
        flat = motion.reshape(len(motion), -1)
        total = np.zeros((len(motion), self._count))
        for whitener, functions in self._regions:
            total += functions(flat * whitener)
        # A piece that is not split has a weight from either side: their mean.
        return total / self._share
