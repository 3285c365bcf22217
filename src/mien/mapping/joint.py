"""The mapper: [B]'s cardinal weights refined jointly under bounds, lids mixed last.

Cardinal weights are exact at the examples but know no bounds, and clipping them one by one takes
apart what cancels; one small quadratic programme a frame does both (``programme``). Without the
cardinal pull it is bounded least squares.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.errors import InputError
from mien.face.character import Character
from mien.face.face import Face
from mien.face.pieces import Pieces, split
from mien.mapping.examples import measure_examples
from mien.mapping.lids import SCALARS, find_lids
from mien.mapping.own import Correction, personal, pose_weights
from mien.mapping.programme import Programme
from mien.mapping.ranges import range_gains
from mien.mapping.regional import RegionalCardinal
from mien.mapping.settings import Settings
from mien.mapping.sight import compare, seen
from mien.numeric.rotation import from_vector, to_vector
from mien.performance.curves import Curves
from mien.performance.performance import Performance

Array = NDArray[np.float64]


_CHUNK = 128
"""Frames solved at a time, which bounds memory."""


class Solves(Protocol):
    """Finds the weights of pieces."""

    def solve(self, motion: Array, unseen: Array) -> Array:
        """Weights (F, W) for ``motion`` (F, Q, 3) mm, of which nothing is known along ``unseen``
        (F, 3)."""


class JointMapper:
    """One character driven by one performer. It has no memory: a frame maps alone as in a take.
    Safe to call from several threads."""

    def __init__(
        self,
        character: Character,
        header: Performance,
        settings: Settings | None = None,
        pieces: Pieces | None = None,
    ) -> None:
        """``header`` is any performance of the performer: its points, neutral, sigma and spans
        are what counts. ``pieces`` are what is driven (those of regions and sides). Raises
        InputError where the two have too little in common."""
        self.settings = settings or Settings()
        self.character = character
        self.pieces = pieces or split(character)
        self._points = header.points
        self.examples = measure_examples(
            character, self.pieces, header.points, header.neutral, self.settings.examples
        )
        self.rows = compare(header, self.examples.points)
        self._range = range_gains(self.settings.ranges, self.examples)
        if self.settings.own is not None:
            wanted = self._whole_motion(self.settings.own.moments)
            posed = pose_weights(self.settings.own, character, self.pieces)
            self.examples = personal(self.examples, wanted, posed)
        self._scale = self._range * self._exaggeration()
        self.cardinal = RegionalCardinal(
            self.examples, self.pieces, self.rows, self.settings.linear_ridge
        )
        self._fields = np.ascontiguousarray(self.rows(self.examples.pieces))
        self._lids = find_lids(character, self.pieces)
        self._programme: Solves = Programme(
            self._fields,
            self.rows.precision,
            len(self.rows.points),
            self.pieces,
            self.cardinal,
            self.settings,
        )
        self._correction = self._corrected()

    def __call__(self, performance: Performance) -> Curves:
        """Curves of the character for every frame of ``performance``, which is by the performer
        the mapper was built for."""
        weights = np.empty((len(performance), len(self.pieces.names)))
        residual = np.empty(len(performance))
        for part in _parts(len(performance)):
            motion, unseen = self._read(performance, part)
            weights[part] = self._solve(motion, unseen, performance, part)
            residual[part] = self._residual(motion, unseen, weights[part])
        rotation, translation = head_on_neck(performance, self.character.face)
        if self.settings.head != 1.0:
            rotation = from_vector(self.settings.head * to_vector(rotation))
            translation = self.settings.head * translation
        return Curves(
            character=self.character.name,
            names=self.pieces.names,
            time=performance.time,
            weights=weights,
            rotation=rotation,
            translation=translation,
            gaze=self.settings.eyes * performance.gaze,
            lost=performance.lost,
            residual=residual,
        )

    def key_weights(self, performance: Performance) -> Array:
        """(F, K) weight of each of the character's examples as the programme has it before lids
        are mixed."""
        parts = [
            self._programme.solve(*self._read(performance, part))
            for part in _parts(len(performance))
        ]
        return self.by_key(np.concatenate(parts))

    def cardinal_weights(self, performance: Performance) -> Array:
        """(F, W) [B]'s cardinal weights alone, of motion that was seen in full."""
        return self.cardinal(self._read(performance, slice(None))[0])

    def by_key(self, weights: Array) -> Array:
        """(F, K) weights of the character's examples, the means of their pieces' (F, W)."""
        own = self.examples.owner[:, None] == np.arange(len(self.character.examples))
        return np.asarray(weights @ (own / np.maximum(own.sum(axis=0), 1)))

    def _read(self, performance: Performance, part: slice) -> tuple[Array, Array]:
        """Motion (F, Q, 3) of the compared rows, exaggerated, and the unseen directions."""
        if performance.points != self._points:
            raise ValueError("the performance has other feature points than the mapper's header")
        motion = performance.motion[part][:, self.rows.points] * self._scale
        return self.rows(motion), performance.unseen[part]

    def _exaggeration(self) -> Array:
        """(P, 1) by which each point's motion is multiplied."""
        sliders = np.array([self.settings.brows, self.settings.eyes, self.settings.mouth])
        share = sliders @ self.examples.masks.sum(axis=1)
        return np.asarray(self.settings.gain * share[:, None])

    def _whole_motion(self, moments: Performance) -> Array:
        """(M, P, 3) of the performer's own moments, as it was."""
        if moments.points != self._points:
            raise InputError("own examples: other feature points than the performance has")
        return moments.motion[:, self.rows.points] * self._range

    def _corrected(self) -> Correction | None:
        """What makes own examples exact; None without any."""
        if self.settings.own is None:
            return None
        moments = self.settings.own.moments
        motion = self.rows(self._whole_motion(moments))
        found = self._mix(self._programme.solve(motion, moments.unseen), moments, slice(None))
        wanted = pose_weights(self.settings.own, self.character, self.pieces)
        return Correction(motion * np.sqrt(self.rows.precision), wanted - found)

    def _solve(self, motion: Array, unseen: Array, performance: Performance, part: slice) -> Array:
        """(F, W) weights with lids mixed and own examples met."""
        weights = self._mix(self._programme.solve(motion, unseen), performance, part)
        if self._correction is not None:
            weights += self._correction(motion * np.sqrt(self.rows.precision), seen(unseen))
        return weights

    def _mix(self, weights: Array, performance: Performance, part: slice) -> Array:
        """Weights with the lids as the performer's closures have them, where those are known."""
        if self._lids is None or any(name not in performance.scalars for name in SCALARS):
            return weights
        closure = np.stack([performance.scalars[name][part] for name in SCALARS], axis=-1)
        return self._lids.mix(weights, np.minimum(self.settings.eyes * closure, 1.0))

    def _residual(self, motion: Array, unseen: Array, weights: Array) -> Array:
        """(F,) mm, root mean square over the points of what was seen and not expressed."""
        shown = (weights @ self._fields.reshape(len(self._fields), -1)).reshape(motion.shape)
        return _unexpressed(motion, shown, unseen, len(self.rows.points))


@njit(cache=True, nogil=True)
def _unexpressed(motion: Array, shown: Array, unseen: Array, points: int) -> Array:
    """(F,) root mean square over the first ``points`` of ``motion - shown`` (F, Q, 3), without
    what lies along ``unseen`` (F, 3)."""
    left = np.empty(len(motion))
    for f in range(len(motion)):
        total = 0.0
        for q in range(points):
            square, along = 0.0, 0.0
            for x in range(3):
                miss = motion[f, q, x] - shown[f, q, x]
                square += miss * miss
                along += miss * unseen[f, x]
            total += max(square - along * along, 0.0)
        left[f] = np.sqrt(total / points)
    return left


def head_on_neck(performance: Performance, face: Face) -> tuple[Array, Array]:
    """Rotation (F, 3, 3) about the neck of ``face`` and translation (F, 3) mm of all of it.

    A performance tells where the point between the eyes is; a neck that turns already carries it
    about, and only the rest is a step to the side.
    """
    rotation, translation = performance.head()
    return rotation, translation + (rotation - np.eye(3)) @ face.pivots["head"]


def _parts(frames: int) -> Iterator[slice]:
    for first in range(0, frames, _CHUNK):
        yield slice(first, min(first + _CHUNK, frames))
