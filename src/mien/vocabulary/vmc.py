"""Names under which the VMC protocol carries faces: ARKit's 52, and the presets of VRM 0.x that
every receiver knows. Source: protocol.vmc.info (MIT) and the VRM specification; which shapes make
a preset is ours."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import numpy as np
from numpy.typing import NDArray

from mien.vocabulary.arkit import names, pascal

Array = NDArray[np.float64]

LOOK = np.radians(35.0)
"""Gaze angle at which LookLeft and its like are 1."""

_SAYS: Mapping[str, Mapping[str, float]] = {
    "A": {"jawOpen": 0.7, "mouthLowerDownLeft": 0.3, "mouthLowerDownRight": 0.3},
    "I": {"mouthStretchLeft": 0.6, "mouthStretchRight": 0.6, "jawOpen": 0.1},
    "U": {"mouthPucker": 0.8, "jawOpen": 0.1},
    "E": {"mouthUpperUpLeft": 0.3, "mouthUpperUpRight": 0.3, "jawOpen": 0.25},
    "O": {"mouthFunnel": 0.7, "jawOpen": 0.35},
    "Blink": {"eyeBlinkLeft": 1.0, "eyeBlinkRight": 1.0},
    "Blink_L": {"eyeBlinkLeft": 1.0},
    "Blink_R": {"eyeBlinkRight": 1.0},
    "Joy": {"mouthSmileLeft": 0.9, "mouthSmileRight": 0.9, "cheekSquintLeft": 0.5,
            "cheekSquintRight": 0.5},
    "Angry": {"browDownLeft": 1.0, "browDownRight": 1.0, "noseSneerLeft": 0.4,
              "noseSneerRight": 0.4, "mouthPressLeft": 0.4, "mouthPressRight": 0.4},
    "Sorrow": {"browInnerUp": 0.9, "mouthFrownLeft": 0.8, "mouthFrownRight": 0.8},
    "Fun": {"mouthSmileLeft": 0.5, "mouthSmileRight": 0.5, "eyeSquintLeft": 0.5,
            "eyeSquintRight": 0.5},
}  # fmt: skip
"""What each preset asks of a face that speaks ARKit."""

PRESETS = (*_SAYS, "LookUp", "LookDown", "LookLeft", "LookRight", "Neutral")
"""VRM 0.x expression names as VMC spells them."""


@cache
def _table() -> Array:
    """(P, 52) shapes of the presets that shapes make."""
    spoken = names()
    table = np.zeros((len(_SAYS), len(spoken)))
    for row, shares in enumerate(_SAYS.values()):
        for name, share in shares.items():
            table[row, spoken.index(name)] = share
    return table


def presets_of(shapes: Array, gaze: Array) -> dict[str, float]:
    """Weights of all PRESETS for ARKit ``shapes`` (52,) and ``gaze`` (2, 2): for receivers that
    know no others. A preset is as strong as the weakest of what makes it."""
    table = _table()
    with np.errstate(divide="ignore", invalid="ignore"):
        reached = np.where(table > 0.0, shapes / table, np.inf).min(axis=1)
    weights = dict(zip(_SAYS, np.clip(reached, 0.0, 1.0).tolist(), strict=True))
    yaw, pitch = gaze.mean(axis=0) / LOOK
    looks = {"LookLeft": yaw, "LookRight": -yaw, "LookUp": pitch, "LookDown": -pitch}
    weights |= {name: float(np.clip(level, 0.0, 1.0)) for name, level in looks.items()}
    return weights | {"Neutral": 0.0}


def shapes_of(presets: Mapping[str, float]) -> Array:
    """(52,) ARKit weights of preset weights by lower-case name: what a sender shows who speaks no
    ARKit. "blink" counts where no single eye is told."""
    told = dict(presets)
    if told.get("blink_l", 0.0) or told.get("blink_r", 0.0):
        told["blink"] = 0.0
    levels = np.array([told.get(name.lower(), 0.0) for name in _SAYS])
    return np.asarray(np.clip(levels @ _table(), 0.0, 1.0))


@cache
def arkit_rows() -> Mapping[str, int]:
    """Row of each ARKit shape by its name in lower case: senders differ in capitals."""
    return {name.lower(): row for row, name in enumerate(names())}


def spelled() -> tuple[str, ...]:
    """(52) ARKit's names as VMC tools write them: "EyeBlinkLeft"."""
    return tuple(map(pascal, names()))
