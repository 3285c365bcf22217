"""The network of [B] §3.1: eleven mean brightnesses in, four colour weights out.

    symbol      here
    x (11,)     mean brightness of the subareas, over 255
    h (10,)     sigmoid(hidden x + hidden_bias)
    w (4,)      output h + output_bias: the weights of M, K, V and G(H)

Trained by back-propagation through I = w . f + w0 to the error of I against the mask of a feature:
weights for their own sake are no target, for many serve alike (balanced accuracy on unseen people
0.61 when trained on least-squares weights, 0.70 when trained on the mask).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

INPUTS, HIDDEN, OUTPUTS = 11, 10, 4
_SCALE = 255.0
_PACE, _INERTIA = 0.05, 0.9
"""Step and momentum of the descent."""


@dataclass(frozen=True, slots=True)
class Network:
    """Three layers, 11-10-4; and the constant w0 of the transformation, learnt with them."""

    hidden: Array
    """(10, 11)"""
    hidden_bias: Array
    """(10,)"""
    output: Array
    """(4, 10)"""
    output_bias: Array
    """(4,)"""
    constant: float

    def __call__(self, means: Array) -> Array:
        """(..., 4) weights for subareas of ``means`` (..., 11)."""
        return np.asarray(
            _sigmoid(means / _SCALE @ self.hidden.T + self.hidden_bias) @ self.output.T
            + self.output_bias
        )


@dataclass(frozen=True, slots=True)
class Lesson:
    """One picture with a known feature."""

    means: Array
    """(11,) of its subareas."""
    channels: Array
    """(N, 4) M, K, V, G(H) of pixels in and round the feature."""
    wanted: Array
    """(N,) 1 in the feature, 0 outside."""
    share: Array
    """(N,) what a pixel counts; sums to 1."""


def untrained(weights: Array, constant: float, seed: int = 0) -> Network:
    """A network that gives ``weights`` (4,) whatever it sees."""
    random = np.random.default_rng(seed)
    return Network(
        hidden=random.normal(0.0, 1.0 / np.sqrt(INPUTS), (HIDDEN, INPUTS)),
        hidden_bias=np.zeros(HIDDEN),
        output=np.zeros((OUTPUTS, HIDDEN)),
        output_bias=np.array(weights, dtype=float),
        constant=float(constant),
    )


def error(network: Network, lesson: Lesson) -> tuple[float, Network]:
    """Mean squared error of I against the mask, and its gradient by every weight, laid out as a
    network (back-propagation, Rumelhart, Hinton and Williams 1986)."""
    x = lesson.means / _SCALE
    h = _sigmoid(network.hidden @ x + network.hidden_bias)
    weights = network.output @ h + network.output_bias
    miss = lesson.channels @ weights + network.constant - lesson.wanted
    by_intensity = 2.0 * lesson.share * miss
    by_weights = by_intensity @ lesson.channels
    by_hidden = (network.output.T @ by_weights) * h * (1.0 - h)
    return float(lesson.share @ miss**2), Network(
        hidden=np.outer(by_hidden, x),
        hidden_bias=by_hidden,
        output=np.outer(by_weights, h),
        output_bias=by_weights,
        constant=float(by_intensity.sum()),
    )


def train(network: Network, lessons: Sequence[Lesson], rounds: int = 300) -> Network:
    """``network`` after ``rounds`` of descent with momentum over all ``lessons`` at once."""
    place = _flat(network)
    speed = np.zeros_like(place)
    for _ in range(rounds):
        gradients = [_flat(error(_shaped(place), lesson)[1]) for lesson in lessons]
        speed = _INERTIA * speed - _PACE * np.mean(gradients, axis=0)
        place = place + speed
    return _shaped(place)


def _sigmoid(x: Array) -> Array:
    return np.asarray(1.0 / (1.0 + np.exp(-x)))


def _flat(network: Network) -> Array:
    return np.concatenate(
        [
            network.hidden.ravel(),
            network.hidden_bias,
            network.output.ravel(),
            network.output_bias,
            [network.constant],
        ]
    )


def _shaped(numbers: Array) -> Network:
    ends = np.cumsum([HIDDEN * INPUTS, HIDDEN, OUTPUTS * HIDDEN, OUTPUTS])
    hidden, hidden_bias, output, output_bias, constant = np.split(numbers, ends)
    return Network(
        hidden.reshape(HIDDEN, INPUTS),
        hidden_bias,
        output.reshape(OUTPUTS, HIDDEN),
        output_bias,
        float(constant[0]),
    )
