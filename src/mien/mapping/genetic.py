"""Genetic blending [Z] §4.2: a population of faces holds tournaments until one shows the motion.

The population is the databank. In every generation three random members meet; the worst by the
fitness (the distance to the motion at the feature points) leaves, and the offspring of the other
two takes its place: a p + (1 - a) q with one random a. After 70 generations the best member that
ever lived is the result. The paper does not say how offspring is mixed; of six crossovers tried
this one comes nearest to its words.

As ``published`` the pool collapses on a few faces, whatever the number of generations: nothing new
ever comes into it. ``genetic`` puts the neutral into the population and mutates one weight of
every offspring; it comes within a few hundredths of the exact optimum (``bounded``), which costs a
tenth of the time.

All frames run the same tournaments, so that each maps alone as it does in a take, and neighbours
differ by their motion only.
"""

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np
from numpy.typing import NDArray

from mien.mapping.blend import Blend

Array = NDArray[np.float64]
Index = NDArray[np.intp]

GENERATIONS = 70
_MUTATING = 8000
"""Generations of the repaired variant."""
_STEP = 0.2
"""A mutation's standard deviation, in weights that would change the cost by as much as the best
member's."""


@dataclass(frozen=True, slots=True)
class Tournaments:
    """All that chance decides, for T generations among N members."""

    rivals: Index
    """(T, 3) three different members each."""
    shares: Array
    """(T,) the first winner's share of the offspring."""
    genes: Index
    """(T,) which weight mutates."""
    steps: Array
    """(T,) by how much, in standard deviations; 0 for none."""


def draw(
    random: np.random.Generator, generations: int, members: int, genes: int, step: float = 0.0
) -> Tournaments:
    """Tournaments at random; ``step`` scales the mutations, 0 leaves them out. Raises ValueError
    for fewer than three members."""
    if members < 3:
        raise ValueError(f"a tournament needs three members, not {members}")
    order = random.random((generations, members)).argsort(axis=1)
    return Tournaments(
        rivals=order[:, :3],
        shares=random.random(generations),
        genes=random.integers(0, genes, generations),
        steps=step * random.standard_normal(generations),
    )


def published(problem: Blend, seed: int = 0, generations: int = GENERATIONS) -> Array:
    """Weights (F, K) as published: convex mixes of the databank, which never rests."""
    count = len(problem.gram)
    chance = draw(np.random.default_rng(seed), generations, count, count)
    return evolve(problem.gram, problem.onto, problem.square, np.eye(count), chance)


def genetic(problem: Blend, seed: int = 0, generations: int = _MUTATING) -> Array:
    """Weights (F, K) between 0 and 1, with the neutral in the population and mutation."""
    count = len(problem.gram)
    chance = draw(np.random.default_rng(seed), generations, count + 1, count, _STEP)
    start = np.concatenate([np.zeros((1, count)), np.eye(count)])
    return evolve(problem.with_prior(), problem.onto, problem.square, start, chance)


def evolve(gram: Array, onto: Array, square: Array, start: Array, chance: Tournaments) -> Array:
    """The best weights (F, K) that lived, from a population that starts as ``start`` (N, K).

    Fitness is w' G w - 2 w' b + c with ``gram`` (K, K), ``onto`` (F, K), ``square`` (F,).
    """
    return np.asarray(
        _evolve(gram, onto, square, start, chance.rivals, chance.shares, chance.genes, chance.steps)
    )


@numba.njit(cache=True)
def _evolve(  # type: ignore[no-untyped-def]
    gram, onto, square, start, rivals, shares, genes, steps
):
    frames, count = onto.shape
    members = len(start)
    result = np.empty((frames, count))
    pulls = start @ gram
    weights, slopes = np.empty_like(start), np.empty_like(start)
    costs = np.empty(members)
    for f in range(frames):
        # A member's slope G w - b mixes as its weights do: no generation needs a product with G.
        for i in range(members):
            costs[i] = square[f]
            for k in range(count):
                weights[i, k] = start[i, k]
                slopes[i, k] = pulls[i, k] - onto[f, k]
                costs[i] += weights[i, k] * (slopes[i, k] - onto[f, k])
        best = np.argmin(costs)
        least = costs[best]
        result[f] = weights[best]
        for t in range(len(shares)):
            i, j, worst = rivals[t]
            if costs[i] > costs[worst]:
                i, worst = worst, i
            if costs[j] > costs[worst]:
                j, worst = worst, j
            share = shares[t]
            for k in range(count):
                weights[worst, k] = share * weights[i, k] + (1.0 - share) * weights[j, k]
                slopes[worst, k] = share * slopes[i, k] + (1.0 - share) * slopes[j, k]
            if steps[t] != 0.0:
                gene = genes[t]
                step = steps[t] * np.sqrt(max(least, 0.0) / gram[gene, gene])
                mutant = min(max(weights[worst, gene] + step, 0.0), 1.0)
                step = mutant - weights[worst, gene]
                weights[worst, gene] = mutant
                for k in range(count):
                    slopes[worst, k] += step * gram[gene, k]
            cost = square[f]
            for k in range(count):
                cost += weights[worst, k] * (slopes[worst, k] - onto[f, k])
            costs[worst] = cost
            if cost < least:
                least = cost
                result[f] = weights[worst]
    return result
