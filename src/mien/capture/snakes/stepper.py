"""The snakes at work: one frame after the other, each from where the last one left off."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.curves.features import LASTING, MOUTH, ROW, usual_features
from mien.capture.snakes.curves.fields import Weigh, usual_weights
from mien.capture.snakes.fit import Known, fit
from mien.capture.snakes.head.box import find_face
from mien.capture.snakes.head.flow import NOSE, choose, follow, steepness
from mien.capture.snakes.head.patch import EYES, Picture, Placement, grey_of
from mien.capture.snakes.head.pose import RESTING, Pose
from mien.capture.snakes.head.relief import lifted
from mien.capture.snakes.head.rigid import Rigid, neck_of, remembered
from mien.capture.snakes.seen import Seen, Start

Array = NDArray[np.float64]

_EYES = np.array([ROW["eye_right"], ROW["eye_left"]])
_UPPER_FACE = [ROW[name] for name in ("eye_right", "eye_left", "brow_right", "brow_left")]
_FIRST_ROUNDS = 4
"""How often the first patch is moved until the eyes lie where eyes are."""
_PUPILS_APART, _LIKELY = 1.03, (0.8, 1.2)
"""Distance of the pupils in distances of the eyes' middles, and how far a face may differ."""
_FEWEST = 3
"""Features that must be found for a face to be there."""
_SECOND_LOOKS, _CLEARER, _CLEAR = (6, 24, 96), 1.25, 1.6
"""A first look may be a bad one (eyes shut, blur). So many frames after it the face is looked for
as if it were new, and learnt anew where eyes and brows then stand out so much more; unless they
stand out so much anyway."""
_PATIENCE = 5
"""Frames without them after which the face is looked for anew."""


@dataclass(frozen=True, slots=True)
class Appearance:
    """What a performer looks like at rest: with it, the first frame is like any other."""

    rest: Array
    """(L, 6, 2) features, patch units."""
    anchor: Picture
    """(HEIGHT, WIDTH) grey patch of the resting face."""
    points: Array
    """(COUNT, 2) what is followed on it, patch units."""


class SnakeCapture:
    """Follows one face from frame to frame. The same frames give the same numbers, whoever feeds
    them."""

    def __init__(
        self,
        appearance: Appearance | None = None,
        weigh: Weigh = usual_weights,
        light: bool = True,
    ) -> None:
        """``appearance`` of a known performer (else learnt from the first frame with a face);
        ``weigh`` gives the colour weights; ``light`` False judges all frames by the skin of the
        first."""
        self._weigh, self._light = weigh, light
        self._gains: Array | None = None
        self._last: Seen | None = None
        self._neck: Array | None = None
        """Pixels of the frame; it stays where it was while no face is seen."""
        self._missing = 0
        self._looked: int | None = None
        self.appearance: Appearance | None = None
        self._rest = lifted(usual_features(), usual_features())
        if appearance is not None:
            self._remember(appearance)

    def step(self, image: Picture) -> Seen | None:
        """Look at the next picture (H, W, 3) RGB; None where no face is seen."""
        start = self._follow(image)
        recovered = start is None
        if start is None:
            start = self._find(image)
        if start is None:
            self._last = None
            return None
        seen = replace(self._fit(start, image), recovered=recovered)
        few = int((~seen.lost[LASTING]).sum()) < _FEWEST
        self._missing = self._missing + 1 if few else 0
        if few and (recovered or self._missing > _PATIENCE):
            self._last, self._missing = None, 0
            return None
        if self.appearance is None:
            self._looked = 0
            seen = self._learn(seen)
        elif self._looked is not None:
            self._looked += 1
            if self._looked in _SECOND_LOOKS and _clearness(seen) < _CLEAR:
                seen = self._look_again(seen, image)
        self._last = seen
        return seen

    def _learn(self, seen: Seen) -> Seen:
        """Take what was seen for the performer at rest, and the usual for what was not."""
        points = choose(seen.grey)
        rest = np.where(seen.lost[:, None, None], usual_features(), seen.lenses[:MOUTH])
        self._remember(Appearance(rest, seen.grey, points))
        return replace(seen, rigid=points)

    def _look_again(self, seen: Seen, image: Picture) -> Seen:
        """``seen``, or what somebody sees who has never seen this face, where that is clearer."""
        stranger = SnakeCapture(None, self._weigh, self._light)
        stranger._gains = self._gains
        fresh = stranger.step(image)
        if fresh is None or _clearness(fresh) < _CLEARER * _clearness(seen):
            return seen
        return self._learn(replace(fresh, recovered=True))

    def _remember(self, appearance: Appearance) -> None:
        self.appearance = appearance
        self._rest = lifted(appearance.rest, appearance.rest)
        points = lifted(appearance.points, appearance.rest)
        weight = steepness(appearance.anchor, appearance.points)
        self._rigid = Rigid.of(points, weight, self._rest[_EYES, :2].reshape(-1, 3))

    def _follow(self, image: Picture) -> Start | None:
        """Where the last frame's face went."""
        if self._last is None or self.appearance is None:
            return None
        last, known = self._last, self.appearance
        grey = grey_of(last.placement.warp(image, NOSE))
        moved = follow(known.anchor, known.points, last.rigid, grey)
        if moved is None:
            moved = follow(last.grey, last.rigid, last.rigid, grey)
        if moved is None:
            return None
        carried = last.lenses @ moved.similarity[:, :2].T + moved.similarity[:, 2]
        return self._turned(last.placement, moved.points, carried, last.pose)

    def _turned(self, placement: Placement, rigid: Array, lenses: Array, pose: Pose) -> Start:
        """The start with the patch put where the head's scale, roll and place are those at rest;
        ``rigid`` and ``lenses`` were seen in the patch of ``placement``."""
        corners = lenses[_EYES, :2].reshape(-1, 2)
        neck = [] if self._neck is None else [placement.to_patch(self._neck)[None]]
        pose = self._rigid.pose(np.concatenate([rigid, corners, *neck]), pose)
        self._neck = remembered(self._neck, neck_of(placement, pose))
        back, level = pose.levelled()
        on = Placement(back)
        return Start(placement.moved(back), level, on.to_patch(lenses), on.to_patch(rigid))

    def _find(self, image: Picture) -> Start | None:
        """Look for a face in the whole picture, and bring its patch right."""
        placement = find_face(image)
        if placement is None:
            return None
        lenses = np.concatenate([self._rest, self._rest[-1:]])[..., :2]
        known = self.appearance is not None
        eyes = self._rest[_EYES, :2, :2].mean(axis=1) if known else EYES
        for _ in range(_FIRST_ROUNDS):
            start = Start(placement, RESTING, lenses, np.zeros((0, 2)))
            seen = self._fit(start, image, strange=True)
            better = Placement.at(placement.to_frame(_middles(seen)), eyes)
            lenses = better.to_patch(placement.to_frame(seen.lenses))
            placement = better
        if self.appearance is None:
            return Start(placement, RESTING, lenses, np.zeros((0, 2)))
        points = self.appearance.points
        grey = grey_of(placement.warp(image, NOSE))
        moved = follow(self.appearance.anchor, points, points, grey)
        there = points if moved is None else moved.points
        return self._turned(placement, there, lenses, RESTING)

    def _fit(self, start: Start, image: Picture, strange: bool = False) -> Seen:
        """Let all curves settle; ``strange`` where it is not sure whether the patch lies right."""
        learnt = self.appearance is not None
        known = Known(self._rest, learnt, self._last, self._weigh, self._gains)
        seen = fit(image, start, known, strange)
        if not self._light and self._gains is None:
            self._gains = seen.look.gains
        return seen


def _middles(seen: Seen) -> Array:
    """(2, 2) of the right and the left eye, patch units. Paint and shadow beside the eyes pull both
    outwards; the irises between them are not painted."""
    corners = seen.lenses[_EYES, :2].mean(axis=1)
    middle, across = corners.mean(axis=0), 0.5 * (corners[1] - corners[0])
    apart = float(np.linalg.norm(seen.irises.places[1] - seen.irises.places[0])) / _PUPILS_APART
    share = apart / max(2.0 * float(np.linalg.norm(across)), 1e-6)
    if _LIKELY[0] < share < _LIKELY[1]:
        across = across * 0.5 * (1.0 + share)
    return np.stack([middle - across, middle + across])


def _clearness(seen: Seen) -> float:
    """How much eyes and brows stand out."""
    return float(np.where(seen.lost, 0.0, seen.contrast)[_UPPER_FACE].sum())
