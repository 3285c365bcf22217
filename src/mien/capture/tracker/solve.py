"""The likeliest state of a frame: terms summed, expressions kept within their bounds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from mien.capture.tracker.state import State
from mien.numeric.gauss_newton import Linearized, bounded_step, normal_equations

WEIGHT_MAX = 1.2


class Term(Protocol):
    """Something that is known of a frame. A module each; all are held to central differences by
    one test."""

    def linearize(self, state: State) -> Linearized:
        """Residual and Jacobian about ``state``."""


def step(state: State, terms: Sequence[Term]) -> State:
    """``state`` after one Gauss-Newton step on the sum of ``terms``."""
    unknowns = 6 + len(state.weights)
    normal, right = normal_equations((term.linearize(state) for term in terms), unknowns)
    value = np.concatenate([np.zeros(6), state.weights])
    least = np.concatenate([np.full(6, -np.inf), np.zeros(len(state.weights))])
    most = np.concatenate([np.full(6, np.inf), np.full(len(state.weights), WEIGHT_MAX)])
    moved = state.moved(bounded_step(normal, right, value, least, most))
    return replace(moved, weights=np.clip(moved.weights, 0.0, WEIGHT_MAX))


def solve(state: State, terms: Sequence[Term], rounds: int) -> State:
    """``rounds`` steps from ``state``."""
    for _ in range(rounds):
        state = step(state, terms)
    return state
