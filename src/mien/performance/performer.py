"""A performer: what earlier takes told of somebody, so that later ones need not learn it again."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Section = Mapping[str, Array]


@dataclass(frozen=True, slots=True, eq=False)
class HeldFace:
    """A face that was held, and what a character is to do then."""

    capture: str
    """The capture that saw it: its points are meant."""
    character: str
    """Who is meant; empty for all that have the key models of ``pose``."""
    pose: Mapping[str, float]
    """Weights of key models or of their pieces; the others are 0."""
    motion: Array
    """(P, 3) mm from neutral, head frame."""
    unseen: Array
    """(3,) direction along which nothing was measured."""
    lids: Array
    """(2,) closure of the left and right eye."""


@dataclass(frozen=True, slots=True)
class Performer:
    """Named arrays, a section for each capture; each capture knows its own (see
    ``capture.known``) and ignores the others'."""

    landmarks: Section = field(default_factory=dict)
    """What the landmark capture learnt; empty where it did not look."""
    curves: Section = field(default_factory=dict)
    """What the curve capture learnt: the face at rest, lids, and the weights of the networks."""
    poses: Section = field(default_factory=dict)
    """(P, 3) mm each: motion of the key poses that were held, by "capture/name"; P in the order
    of the capture's points."""
    source: str = ""
    """The takes it was learnt from, for a person to read."""
    held: tuple[HeldFace, ...] = ()
    """Faces that stand for what single characters do."""
