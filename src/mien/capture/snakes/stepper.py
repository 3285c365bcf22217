"""The snakes at work: one frame after the other, each from where the last one left off."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from mien.capture.snakes.blobs import above, without_hair
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
from mien.capture.snakes.features import FEATURES, MOUTH, ROW, usual_features
from mien.capture.snakes.flow import choose, follow
from mien.capture.snakes.mouth import (
    LipColour,
    filled,
    find_opening,
    inside_masks,
    lip_colour,
    moustache,
)
from mien.capture.snakes.patch import ORIGIN, Picture, Placement
from mien.capture.snakes.pose import RESTING, Pose, fit_pose
from mien.capture.snakes.relief import lifted
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
    pose: Pose
    lenses: Array
    grey: Picture
    rigid: Array
    lips: LipColour


class SnakeCapture:
    """Follows one face from frame to frame."""

    def __init__(self) -> None:
        self._rest = lifted(usual_features())
        self._state: _State | None = None
        self._anchor: Picture | None = None
        self._known = False

    def step(self, frame: Frame) -> Seen | None:
        """Look at the next frame; None where no face is seen."""
        followed = self._follow(frame.image)
        recovered = followed is None
        if followed is None:
            followed = self._find(frame.image)
            if followed is None:
                return None
        placement, pose, rigid, lenses = followed
        patch = placement.warp(frame.image)
        fitted, energies, opening, lips = self._fit(patch, pose, lenses, self._known)
        if not self._known:
            self._rest = lifted(fitted[:MOUTH])
            self._known = True
        grey = cv2.cvtColor(patch, cv2.COLOR_RGB2GRAY)
        if self._anchor is None:
            self._anchor = grey
            self._points = lifted(choose(grey))
            rigid = self._points[:, :2]
        self._state = _State(placement, pose, fitted, grey, rigid, lips)
        return Seen(placement, fitted, rigid, energies, opening.teeth, opening.tongue, recovered)

    def _follow(self, image):
        if self._state is None:
            return None
        s = self._state
        grey = cv2.cvtColor(s.placement.warp(image), cv2.COLOR_RGB2GRAY)
        moved = follow(self._anchor, self._points[:, :2], s.rigid, grey)
        if moved is None:
            moved = follow(s.grey, s.rigid, s.rigid, grey)
        if moved is None:
            return None
        turn = moved.similarity
        corners = s.lenses[_EYES, :2].reshape(-1, 2) @ turn[:, :2].T + turn[:, 2]
        lenses = s.lenses @ turn[:, :2].T + turn[:, 2]
        pose = fit_pose(self._points, moved.points, s.pose)
        # the new placement takes scale, roll and shift away
        roll = np.arctan2(pose.rotation[1, 0], pose.rotation[0, 0])
        c, n = np.cos(roll) / pose.scale, np.sin(roll) / pose.scale
        back = np.array([[c, n], [-n, c]])
        sim = np.column_stack([back, -back @ pose.shift])
        placement = s.placement.moved(sim)
        R = np.array([[np.cos(roll), np.sin(roll), 0], [-np.sin(roll), np.cos(roll), 0], [0, 0, 1]])
        pose = Pose(R @ pose.rotation, 1.0, np.zeros(2))
        on = lambda q: q @ sim[:, :2].T + sim[:, 2]
        return placement, pose, on(moved.points), on(lenses)

    def _find(self, image):
        placement = find_face(image)
        if placement is None:
            return None
        lenses = (
            np.concatenate([self._rest, self._rest[-1:]])[..., :2]
            if self._state is None
            else self._state.lenses
        )
        for _ in range(_FIRST_ROUNDS):
            lenses, *_ = self._fit(placement.warp(image), RESTING, lenses, False)
            middles = lenses[_EYES, :2].mean(axis=1)
            better = Placement.at(*placement.to_frame(middles))
            lenses = better.to_patch(placement.to_frame(lenses))
            placement = better
        return placement, RESTING, None if self._anchor is None else self._points[:, :2], lenses

    def _fit(self, patch, pose, lenses, known):
        scale = gains(skin_colour(patch))
        value = brightness(patch, scale)
        mean = neighbourhood(value)
        out = lenses.copy()
        rest = pose(self._rest)
        energies = np.zeros(MOUTH)
        for i, feature in enumerate(FEATURES):
            field = transform(patch, scale, value, mean, USUAL_WEIGHTS[feature.group], feature.box)
            if feature.group == "brow":
                eye = out[ROW[feature.name.replace("brow", "eye")]]
                field = above(field, eye, np.array(feature.box[:2], dtype=float))
                field = without_hair(field, rest[i].mean(axis=0) - feature.box[:2])
            if feature.group == "eye":
                pale = transform(patch, scale, value, mean, USUAL_WEIGHTS["sclera"], feature.box)
                field = np.maximum(field, pale)
            left, top, right, bottom = window(feature.box)
            corner = np.array([left, top]) - ORIGIN
            if feature.group == "lip":
                bright, pink = value[top:bottom, left:right], magenta(patch, scale, feature.box)
                lips = (
                    self._state.lips if self._state else lip_colour(lenses[i], bright, pink, corner)
                )
                dark, teeth = inside_masks(bright, pink, lips)
                grown = cv2.dilate(filled(lenses[i], corner, field.shape), _GROWN)
                if known and not moustache(lenses[i], bright, corner):
                    field = np.maximum(field, ((dark | teeth) & grown).astype(np.float32))
            settled = settle(feature.group, field, corner, rest[i], lenses[i], known)
            out[i], energies[i] = settled.lens, settled.energy
        lips = lip_colour(out[i], bright, pink, corner)
        dark, teeth = inside_masks(bright, pink, lips)
        opening = find_opening(out[i], bright, dark, teeth, corner)
        out[MOUTH] = opening.lens
        return out, energies, opening, lips
