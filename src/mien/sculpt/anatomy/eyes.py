"""Eyeballs with iris and pupil, and the catch lights on them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from mien.sculpt.anatomy.lids import Frame, eye_frame
from mien.sculpt.colour import Colour, linear
from mien.sculpt.proportions import EyeShape
from mien.sculpt.solid import Solid, dome, merged

Array = NDArray[np.float64]

_AROUND = 28
_BACK = 0.62 * np.pi
_CATCH_HEIGHT = 0.12
"""mm above the ball: less flickers, more floats."""


@dataclass(frozen=True, slots=True)
class Iris:
    """Colours and angles (radians from the pole) of an iris."""

    rim: Colour
    middle: Colour
    radius: float = 0.56
    pupil: float = 0.26


def gaze_frame(eye: EyeShape, side: int) -> Frame:
    """The ball's own frame: it looks almost straight ahead, whatever the lids do."""
    return eye_frame(eye, side, eye.gaze_turn)


def eyeball(eye: EyeShape, side: int, iris: Iris) -> Solid:
    """The ball, pole first: its vertex 0 is the centre of the pupil."""
    frame = gaze_frame(eye, side)
    polar = np.concatenate(
        [
            iris.pupil * np.array([0.6, 0.97, 1.03]),
            np.linspace(iris.pupil * 1.1, iris.radius * 0.86, 4),
            iris.radius * np.array([0.93, 0.985, 1.02, 1.08]),
            np.linspace(iris.radius * 1.3, _BACK, 8),
        ]
    )
    angle = np.linspace(0, 2 * np.pi, _AROUND, endpoint=False)
    rings = frame.place(
        np.outer(polar, np.cos(angle)).ravel(),
        np.outer(polar, np.sin(angle)).ravel(),
        eye.radius,
    ).reshape(len(polar), _AROUND, 3)
    pole = frame.centre + eye.radius * frame.ahead
    vertices, triangles = dome(pole, rings)
    colours = linear(np.vstack([_PUPIL, *(_ring_colour(a, angle, iris) for a in polar)]))
    name = "left" if side > 0 else "right"
    return Solid(
        f"eye_{name}",
        "eye",
        vertices,
        triangles if side > 0 else triangles[:, ::-1],
        colours,
        follows=f"eye_{name}",
        shade=0.8,
    )


_PUPIL = np.array([0.012, 0.01, 0.012])


def _ring_colour(polar: float, angle: Array, iris: Iris) -> Array:
    """(C, 3) sRGB round one ring."""
    if polar < iris.pupil * 1.01:
        return np.tile(_PUPIL, (len(angle), 1))
    if polar < iris.radius:
        out = (polar - iris.pupil) / (iris.radius - iris.pupil)
        streaks = 0.5 + 0.5 * np.sin(11 * angle) * np.sin(17 * angle + 1)
        # Light that enters from above is gathered below.
        below = 0.5 - 0.5 * np.sin(angle)
        base = np.array(iris.middle) * (1 - out) + np.array(iris.rim) * out
        light = 0.72 + 0.35 * streaks * (1 - out) + 0.55 * below * (1 - 0.4 * out)
        limbus = 0.45 if out > 0.8 else 1.0
        return np.clip(limbus * base * light[:, None], 0, 1)
    if polar < iris.radius * 1.03:
        return np.tile([0.10, 0.08, 0.08], (len(angle), 1))
    if polar < iris.radius * 1.1:
        return np.tile([0.40, 0.34, 0.34], (len(angle), 1))
    corner = 0.16 * np.clip((polar - 0.9) / 0.6, 0, 1) * np.array([0.2, 1, 1])
    return np.tile(np.array([0.93, 0.92, 0.91]) * (1 - corner), (len(angle), 1))


def catch_light(
    eye: EyeShape,
    side: int,
    size: float = 0.105,
    place: tuple[float, float] = (-0.28, 0.30),
    height: float = _CATCH_HEIGHT,
    second: bool = True,
) -> Solid:
    """Reflections of the key light: a large spot and a small one opposite. Both eyes see the same
    light, so they lie on the same side, not mirrored."""
    frame = gaze_frame(eye, side)
    angle = np.linspace(0, 2 * np.pi, 14, endpoint=False)
    across, above = place[0] * side, place[1]
    spots = [(across, above, size)]
    if second:
        spots.append((-0.75 * across, -0.8 * above, 0.42 * size))
    forms = []
    for u, v, radius in spots:
        ring = (u + radius * np.cos(angle), v + 1.15 * radius * np.sin(angle))
        distance = eye.radius + height
        centre = frame.place(np.array([u]), np.array([v]), distance)
        forms.append(dome(centre, frame.place(*ring, distance)[None]))
    vertices, triangles = merged(forms)
    name = "left" if side > 0 else "right"
    return Solid(
        f"catch_{name}",
        "catch_light",
        vertices,
        triangles if side > 0 else triangles[:, ::-1],
        np.ones(3),
        follows=f"eye_{name}",
        shade=0.0,
    )
