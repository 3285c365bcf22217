"""A character's key models as the population of the genetic algorithm [Z] §4.2.

Key models act whole: the paper blends faces. It is the repaired algorithm that drives characters:
as published no face of the population is neutral, and nobody would ever quite rest.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character
from mien.mapping.blend import Blend, Solver
from mien.mapping.genetic import genetic
from mien.mapping.joint import JointMapper
from mien.mapping.settings import Settings
from mien.mapping.sight import Sight, seen
from mien.performance.performance import Performance

Array = NDArray[np.float64]


class PopulationMapper(JointMapper):
    """The joint mapper with another way to find weights, one frame by itself."""

    def __init__(
        self, character: Character, header: Performance, settings: Settings | None = None
    ) -> None:
        """As ``JointMapper``."""
        super().__init__(character, header, settings)
        self._programme = Population(
            self.rows(self.examples.keys), self.rows.precision, self.examples.owner, genetic
        )


class Population:
    """K key models that move what is compared by ``fields`` (K, Q, 3), known to ``precision``
    (Q, 3), and which of them owns each of the W pieces."""

    def __init__(
        self, fields: Array, precision: Array, owner: NDArray[np.intp], solver: Solver
    ) -> None:
        self._sight = Sight(fields, precision)
        self._precision = precision
        self._owner = owner
        self._solver = solver

    def solve(self, motion: Array, unseen: Array) -> Array:
        """Weights (F, W) of all pieces for ``motion`` (F, Q, 3) mm, of which nothing is known
        along ``unseen`` (F, 3)."""
        sight = seen(unseen)
        onto = self._sight.onto(motion, sight)
        square = ((motion @ sight) ** 2 * self._precision).sum(axis=(1, 2))
        if (unseen == unseen[:1]).all():
            weights = self._solver(Blend(self._sight.gram(sight[:1])[0], onto, square, 0.0))
        else:
            grams = self._sight.gram(sight)
            frames = (slice(i, i + 1) for i in range(len(grams)))
            weights = np.concatenate(
                [self._solver(Blend(grams[f][0], onto[f], square[f], 0.0)) for f in frames]
            )
        return np.asarray(weights[:, self._owner])
