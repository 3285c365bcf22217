"""p(X): expressions are small, and what moves does not jump."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.capture.tracker.state import State
from mien.numeric.gauss_newton import Linearized

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class PriorTerm:
    """r = w / spread: the shape's own spread about rest."""

    spread: Array
    """(K,)"""

    def linearize(self, state: State) -> Linearized:
        """(K,) residuals."""
        count = len(self.spread)
        jacobian = np.zeros((count, 6 + count))
        jacobian[np.arange(count), 6 + np.arange(count)] = 1.0 / self.spread
        return Linearized(state.weights / self.spread, jacobian)


@dataclass(frozen=True, slots=True)
class MotionTerm:
    """r = (state - expected) / sigma: what the frames before let expect."""

    expected: State
    rotation_sigma: float
    """Radians."""
    translation_sigma: float
    """mm."""
    weight_sigma: float

    def linearize(self, state: State) -> Linearized:
        """(6 + K,) residuals. The turn is taken as a small one."""
        off = state.rotation @ self.expected.rotation.T
        turn = 0.5 * np.array([off[2, 1] - off[1, 2], off[0, 2] - off[2, 0], off[1, 0] - off[0, 1]])
        sigma = np.concatenate(
            [
                np.full(3, self.rotation_sigma),
                np.full(3, self.translation_sigma),
                np.full(len(state.weights), self.weight_sigma),
            ]
        )
        residual = np.concatenate(
            [
                turn,
                state.translation - self.expected.translation,
                state.weights - self.expected.weights,
            ]
        )
        return Linearized(residual / sigma, np.diag(1.0 / sigma))
