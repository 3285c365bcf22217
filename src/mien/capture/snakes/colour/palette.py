"""Colour weights from the networks, for each look anew."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.colour.network import Network
from mien.capture.snakes.colour.regions import means
from mien.capture.snakes.colour.transform import USUAL_WEIGHTS, Weights
from mien.capture.snakes.curves.fields import Look, Weigh, usual_weights

Array = NDArray[np.float64]


def trained(networks: Mapping[str, Network]) -> Weigh:
    """Weights as ``networks`` give them; the usual ones for groups without."""
    if not networks:
        return usual_weights

    def weigh(look: Look, lenses: Array) -> Mapping[str, Weights]:
        seen = means(look.value)
        found = {group: _weights(network, seen) for group, network in networks.items()}
        return {**USUAL_WEIGHTS, **found}

    return weigh


def _weights(network: Network, seen: Array) -> Weights:
    magenta, black, brightness, hue = network(seen).tolist()
    return Weights(magenta, black, min(brightness, 0.0), hue, network.constant)
