"""Wrinkles: lines along which posed skin sinks while what is pushed against them bulges.

The cage is too coarse for them: they are drawn on the subdivided skin.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from mien.sculpt.acting.expression import Expression
from mien.sculpt.anatomy.skin import labels
from mien.sculpt.brush import ramp
from mien.vocabulary import topology

Array = NDArray[np.float64]

_SMILE = np.array([358, 423, 426, 436])
"""Left side: from the wing of the nose down past the corner of the mouth."""
_FROWN = np.array([8, 9])
"""Between the brows, upwards."""
_DEPTH, _HEIGHT = 1.4, 0.9
"""mm at a fold of 1."""
_BROAD, _BESIDE = 3.0, 5.0
"""mm: how broad groove and bulge are, and how far apart."""
_FURROW = 0.2
"""Fold a millimetre that the inner ends of the brows come together."""
_SAMPLES = 24


def wrinkles(neutral: Array, normals: Array, expression: Expression) -> Array:
    """(fine, 3) what ``expression`` adds to the motion of a ``neutral`` skin (fine, 3) with
    ``normals`` (fine, 3)."""
    depth = np.zeros(len(neutral))
    for gain, line in ((expression.left, _SMILE), (expression.right, topology.mirrored(_SMILE))):
        if expression.fold * gain:
            depth += gain * expression.fold * _groove(neutral, line)
    together = -0.5 * (expression.left + expression.right) * expression.brow_inner[0]
    if together > 0:
        depth += _FURROW * together * _groove(neutral, _FROWN)
    return -depth[:, None] * normals


def _groove(neutral: Array, line: NDArray[np.intp]) -> Array:
    """(fine,) mm that the skin sinks about a ``line`` of landmarks, and rises (negative) on that
    side of it which lies farther from the midline."""
    knots = np.linspace(0, len(line) - 1, _SAMPLES)
    samples = np.stack(
        [np.interp(knots, np.arange(len(line)), axis) for axis in neutral[line].T], axis=1
    )
    apart, nearest = cKDTree(samples).query(neutral)
    along = nearest / (_SAMPLES - 1)
    taper = ramp(0.0, 0.25, along + 0.05) * (1 - ramp(0.7, 1.0, along))
    outwards = np.abs(neutral[:, 0]) - np.abs(samples[nearest, 0])
    beside = ramp(0.0, _BESIDE, outwards) * np.exp(-(((apart - _BESIDE) / _BROAD) ** 2))
    sunk = _DEPTH * np.exp(-((apart / _BROAD) ** 2)) - _HEIGHT * beside
    skin = (labels().bag < 0.05) * np.clip(1 - 2 * labels().lips, 0, 1)
    return np.asarray(sunk * taper * skin * (neutral[:, 2] > 0))
