"""The snakes at work: one frame after the other, each from where the last one left off."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.box import find_face
from mien.capture.snakes.colour import (
    USUAL_WEIGHTS,
    Field,
    brightness,
    magenta,
    neighbourhood,
    transform,
    window,
)
from mien.capture.snakes.features import FEATURES, MOUTH, ROW, usual_lenses
from mien.capture.snakes.flow import GRID, follow
from mien.capture.snakes.mouth import (
    LipColour,
    filled,
    find_opening,
    inside_masks,
    lip_colour,
)
from mien.capture.snakes.patch import ORIGIN, Picture, Placement
from mien.capture.snakes.settle import settle
from mien.capture.snakes.skin import gains, skin_colour
from mien.performance.frame import Frame

Array = NDArray[np.float64]

_EYES = np.array([ROW["eye_right"], ROW["eye_left"]])
_EYE_PLACES = np.array([[-50.0, 0.0], [50.0, 0.0]])
_FIRST_ROUNDS = 4
_DRIFT_GAIN = 0.1
_GROWN = np.ones((7, 7), np.uint8)


@dataclass(frozen=True, slots=True)
class Seen:
    """What the snakes found in one frame."""

    placement: Placement
    lenses: Array
    """(7, 6, 2) features and the mouth's opening, patch units."""
    rigid: Array
    """(G, 2) points of nose and inner eyes, patch units."""
    energies: Array
    """(6,)"""
    teeth: float
    tongue: float
    recovered: bool
    """The face had to be found anew."""


@dataclass(frozen=True, slots=True)
class _State:
    placement: Placement
    lenses: Array
    grey: Picture
    rigid: Array
    lips: LipColour


class SnakeCapture:
    """Follows one face from frame to frame."""

    def __init__(self) -> None:
        self._rest = usual_lenses()
        self._state: _State | None = None
        self._anchor: Picture | None = None
        self._anchored: Array = GRID
        self._known = False

    def step(self, frame: Frame) -> Seen | None:
        """Look at the next frame; None where no face is seen."""
        placement, rigid = self._follow(frame.image)
        recovered = placement is None
        if placement is None:
            found = self._find(frame.image)
            if found is None:
                return None
            placement, lenses = found
        else:
            lenses = self._state.lenses
        patch = placement.warp(frame.image)
        fitted, energies, opening, lips = self._fit(patch, lenses, self._known)
        if not self._known:
            self._rest = fitted[:MOUTH].copy()
            self._known = True
        grey = cv2.cvtColor(patch, cv2.COLOR_RGB2GRAY)
        if rigid is None:
            self._anchor, rigid = grey, GRID
        seen = Seen(placement, fitted, rigid, energies, opening.teeth, opening.tongue, recovered)
        self._state = _State(placement, fitted, grey, rigid, lips)
        self._correct()
        return seen

    def _correct(self) -> None:
        s = self._state
        rest = self._rest[_EYES, :2].mean(1)
        now = s.lenses[_EYES, :2].mean(1)
        target = _EYE_PLACES + _DRIFT_GAIN * (now - rest)
        p = Placement.at(s.placement.to_frame(target[0]), s.placement.to_frame(target[1]))
        move = lambda q: p.to_patch(s.placement.to_frame(q))
        # grey stays in the old placement: the next warp is relative to it
        self._next = p

    def _follow(self, image):
        if self._state is None:
            return None, None
        s = self._state
        grey = cv2.cvtColor(s.placement.warp(image), cv2.COLOR_RGB2GRAY)
        moved = follow(self._anchor, GRID, s.rigid, grey)
        if moved is None:
            moved = follow(s.grey, s.rigid, s.rigid, grey)
        if moved is None:
            return None, None
        # drift correction: eyes of last frame
        rest = self._rest[_EYES, :2].mean(1)
        now = s.lenses[_EYES, :2].mean(1)
        eyes = _EYE_PLACES + _DRIFT_GAIN * (now - rest)
        ends = eyes @ moved.similarity[:, :2].T + moved.similarity[:, 2]
        placement = Placement.at(*s.placement.to_frame(ends))
        return placement, placement.to_patch(s.placement.to_frame(moved.points))

    def _find(self, image):
        placement = find_face(image)
        if placement is None:
            return None
        lenses = (
            np.concatenate([self._rest, self._rest[-1:]])
            if self._state is None
            else self._state.lenses
        )
        for _ in range(_FIRST_ROUNDS):
            lenses, *_ = self._fit(placement.warp(image), lenses, False)
            middles = lenses[_EYES, :2].mean(axis=1)
            better = Placement.at(*placement.to_frame(middles))
            lenses = better.to_patch(placement.to_frame(lenses))
            placement = better
        return placement, lenses

    def _fit(self, patch, lenses, known):
        scale = gains(skin_colour(patch))
        value = brightness(patch, scale)
        mean = neighbourhood(value)
        out = lenses.copy()
        energies = np.zeros(MOUTH)
        for i, feature in enumerate(FEATURES):
            field = transform(patch, scale, value, mean, USUAL_WEIGHTS[feature.group], feature.box)
            left, top, right, bottom = window(feature.box)
            corner = np.array([left, top]) - ORIGIN
            if feature.group == "lip":
                bright, pink = value[top:bottom, left:right], magenta(patch, scale, feature.box)
                lips = (
                    self._state.lips if self._state else lip_colour(lenses[i], bright, pink, corner)
                )
                dark, teeth = inside_masks(bright, pink, lips)
                grown = cv2.dilate(filled(lenses[i], corner, field.shape), _GROWN)
                if known:
                    field = np.maximum(field, ((dark | teeth) & grown).astype(np.float32))
            settled = settle(feature.group, field, corner, self._rest[i], lenses[i], known)
            out[i], energies[i] = settled.lens, settled.energy
        lips = lip_colour(out[i], bright, pink, corner)
        dark, teeth = inside_masks(bright, pink, lips)
        opening = find_opening(out[i], bright, dark, teeth, corner)
        out[MOUTH] = opening.lens
        return out, energies, opening, lips
