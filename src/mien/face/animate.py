"""Posing: from one frame of curves to the places of a face's vertices in the world."""

from __future__ import annotations

import numpy as np

from mien.face.character import KeyModels
from mien.face.face import Array, Face
from mien.face.pieces import Pieces
from mien.numeric.blending import blend
from mien.numeric.rotation import from_gaze
from mien.performance.curves import Curves

EYES = ("eye_left", "eye_right")


class Poser:
    """One face and the targets it is driven by, laid out so that a pose costs one sum.

    Morph first ([B] eq. 14), then the eyes about their pivots, then the head about its own.
    Every step adds to the neutral and adds exactly nothing at rest, so that zero weights give
    the neutral bit for bit.
    """

    def __init__(self, face: Face, targets: Pieces | KeyModels) -> None:
        self.face = face
        self.names = targets.names
        moved = np.flatnonzero(targets.displacements.any(axis=(0, 2)))
        # A face has many vertices that no target moves (hair, shirt, eyeballs).
        self._moved = moved
        self._fields = targets.displacements[:, moved].reshape(len(self.names), -1)
        self._eyes = tuple(_carried(face, (eye,)) for eye in EYES)
        self._head = _carried(face, ("head", *EYES))

    def morph(self, weights: Array) -> Array:
        """Vertices (V, 3) in the head frame at ``weights`` (W,), mm."""
        vertices = self.face.vertices.copy()
        motion = blend(np.asarray(weights, dtype=np.float32), self._fields)
        vertices[self._moved] += motion.reshape(-1, 3)
        return vertices

    def pose(
        self,
        weights: Array,
        rotation: Array | None = None,
        translation: Array | None = None,
        gaze: Array | None = None,
    ) -> Array:
        """Vertices (V, 3) in the world, mm.

        ``weights`` (W,); ``rotation`` (3, 3) of the head, which the body does not follow;
        ``translation`` (3,) mm, with which the body goes too: necks turn, they do not stretch;
        ``gaze`` (2, 2) yaw and pitch of the left and right eye, radians.
        """
        vertices = self.morph(weights)
        if gaze is not None:
            for eye, carried, turn in zip(EYES, self._eyes, from_gaze(gaze), strict=True):
                _turn(vertices, carried, turn, self.face.pivots[eye])
        if rotation is not None:
            _turn(vertices, self._head, rotation, self.face.pivots["head"])
        if translation is not None:
            vertices += translation
        return vertices

    def at(self, curves: Curves, frame: int) -> Array:
        """Vertices (V, 3) in the world at one frame of ``curves``.

        Raises ValueError when the curves drive other targets than this face has.
        """
        if curves.names != self.names:
            raise ValueError(f"these curves drive other morph targets than {curves.character}'s")
        return self.pose(
            curves.weights[frame],
            curves.rotation[frame],
            curves.translation[frame],
            curves.gaze[frame],
        )


def _carried(face: Face, carriers: tuple[str, ...]) -> list[slice]:
    """Runs of vertices that belong to parts that follow one of ``carriers``."""
    runs: list[slice] = []
    for part in sorted(face.parts, key=lambda part: part.first):
        if part.follows not in carriers:
            continue
        if runs and runs[-1].stop == part.first:
            runs[-1] = slice(runs[-1].start, part.last)
        else:
            runs.append(slice(part.first, part.last))
    return runs


def _turn(vertices: Array, runs: list[slice], rotation: Array, pivot: Array) -> None:
    turn = (rotation - np.eye(3)).T
    for run in runs:
        vertices[run] += (vertices[run] - pivot) @ turn
