"""The One-Euro filter (Casiez, Roussel and Vogel, CHI 2012): steady when still, quick when quick.

    dx  = low-pass(slope of x, slope cutoff)
    y   = low-pass(x, cutoff + beta |dx|)

A low-pass of cutoff f over a step dt keeps 1 / (1 + 1 / (2 pi f dt)) of the new value, with the
real dt: a variable frame rate changes nothing.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

Array = NDArray[np.float64]

_SHORTEST = 1e-4
"""Seconds; frames that claim to be closer, or to run backwards, count as this far apart."""


@dataclass(frozen=True, slots=True)
class OneEuro:
    """How one kind of signal is filtered."""

    cutoff: float
    """Hz, at rest."""
    beta: float
    """Hz per unit of the signal a second."""
    slope_cutoff: float = 1.0
    """Hz, of the slope's own low-pass."""


@dataclass(slots=True)
class Memory:
    """What the filter knows of the frames before: the last time, value, slope and result."""

    time: float
    value: Array
    slope: Array
    result: Array


def filter_forward(
    values: Array, time: Array, setting: OneEuro, memory: Memory | None = None
) -> tuple[Array, Memory]:
    """Filter G signals of D coordinates, ``values`` (F, G, D) at ``time`` (F,), causally.

    A signal's coordinates share one speed, the length of their slope. ``memory`` continues an
    earlier call: pieces of a take filter as the whole does. Returns (F, G, D) and the memory.
    """
    values = np.ascontiguousarray(values, dtype=float)
    if memory is None:
        start = values[0]
        memory = Memory(float(time[0]), start, np.zeros_like(start), start)
    slope, result = memory.slope.copy(), memory.result.copy()
    steps = np.maximum(time - np.concatenate([[memory.time], time[:-1]]), _SHORTEST)
    filtered = _run(
        values, steps, memory.value, slope, result, setting.cutoff, setting.beta,
        setting.slope_cutoff,
    )  # fmt: skip
    return filtered, Memory(float(time[-1]), values[-1].copy(), slope, result)


def filter_both_ways(values: Array, time: Array, setting: OneEuro) -> Array:
    """The same forwards and then backwards, which leaves no lag. (F, G, D)."""
    forward, _ = filter_forward(values, time, setting)
    backward, _ = filter_forward(forward[::-1], -time[::-1], setting)
    return backward[::-1]


@njit(cache=True, nogil=True)
def _run(
    values: Array,
    steps: Array,
    last: Array,
    slope: Array,
    result: Array,
    cutoff: float,
    beta: float,
    slope_cutoff: float,
) -> Array:
    frames, signals, coordinates = values.shape
    filtered = np.empty_like(values)
    for f in range(frames):
        turn = 2.0 * np.pi * steps[f]
        keep_slope = turn * slope_cutoff / (1.0 + turn * slope_cutoff)
        before = last if f == 0 else values[f - 1]
        for g in range(signals):
            square = 0.0
            for d in range(coordinates):
                new = (values[f, g, d] - before[g, d]) / steps[f]
                slope[g, d] += keep_slope * (new - slope[g, d])
                square += slope[g, d] ** 2
            quick = turn * (cutoff + beta * np.sqrt(square))
            keep = quick / (1.0 + quick)
            for d in range(coordinates):
                result[g, d] += keep * (values[f, g, d] - result[g, d])
                filtered[f, g, d] = result[g, d]
    return filtered
