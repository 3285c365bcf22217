"""What is in a mouth: teeth on two arcs, gums, a tongue. The lower half turns with the jaw."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.sculpt.acting import jaw
from mien.sculpt.acting.expression import Expression
from mien.sculpt.brush import ramp
from mien.sculpt.colour import linear
from mien.sculpt.proportions import MouthShape
from mien.sculpt.solid import Solid, dome, fan, merged, outward, rounded_box, tube

Array = NDArray[np.float64]

_UPPER = ((4.3, 10.0), (3.4, 9.0), (3.7, 9.6), (3.4, 8.6), (3.6, 8.2), (4.2, 7.6))
_LOWER = ((2.8, 8.0), (3.0, 8.2), (3.4, 8.8), (3.4, 8.0), (3.6, 7.6), (4.2, 7.0))
"""Half width and height of each tooth, from the middle back."""
_WIDEST = 26.0
"""A wide mouth has no wider teeth: they would pierce the cheeks."""
_ARC = 1.62
"""Curvature of the teeth's parabola next to the lips'."""
_TONGUE_SHARE = 0.93
_TONGUE_RISE = 7.0
"""mm, as far forward as up, before the tip goes on forward."""


def _scale(mouth: MouthShape) -> float:
    return min(mouth.half_width, _WIDEST) / 25.0


def teeth(mouth: MouthShape, upper: bool) -> Solid:
    """One row with its gum, at rest."""
    scale = _scale(mouth) * mouth.tooth_scale
    sign = 1.0 if upper else -1.0
    front = mouth.depth - mouth.tooth_back - (0.0 if upper else 1.8)
    height = mouth.height + (1.2 if upper else -2.4)
    forms, along = [], 0.0
    for half, tall in _UPPER if upper else _LOWER:
        half, tall = half * scale, 0.475 * tall * scale
        along += half
        x, z, slope = _arc(mouth, along)
        along += 0.97 * half
        ahead = np.array([1.0, 0, slope]) / np.hypot(1, slope)
        middle = np.array([x, height + sign * 0.35 * tall, front + z])
        axes = np.stack([ahead, [0, 1.0, 0], [-ahead[2], 0, ahead[0]]])
        form = rounded_box(middle, axes, (half, tall, 2.6 * scale))
        forms += [form, (form[0] * [-1, 1, 1], form[1][:, ::-1])]
    count = sum(len(vertices) for vertices, _ in forms)
    forms.append(_gum(mouth, along, height + sign * 5.4 * scale, front - 1.2, scale))
    vertices, triangles = merged(forms)
    colours = np.tile(linear((0.96, 0.94, 0.89)), (len(vertices), 1))
    colours[count:] = linear((0.80, 0.40, 0.40))
    darker = np.clip(1 - 0.42 * (np.abs(vertices[:, 0]) / (26 * scale)) ** 3, 0.35, 1)
    return Solid(
        "teeth_upper" if upper else "teeth_lower",
        "tooth",
        vertices,
        triangles,
        colours * darker[:, None],
        shade=0.25 if upper else 0.6,
        revealed=True,
    )


def _arc(mouth: MouthShape, along: float) -> tuple[float, float, float]:
    """x, z and slope at arc length ``along`` of the parabola the teeth stand on."""
    bend = _ARC * (mouth.depth - mouth.corner_depth) / mouth.half_width**2
    xs = np.linspace(0, 45, 900)
    length = np.append(0, np.cumsum(np.hypot(np.diff(xs), 2 * bend * xs[1:] * np.diff(xs))))
    x = float(np.interp(along, length, xs))
    return x, -bend * x * x, -2 * bend * x


def _gum(
    mouth: MouthShape, reach: float, height: float, front: float, scale: float
) -> tuple[Array, NDArray[np.intp]]:
    path = []
    for along in np.linspace(-reach, reach, 19):
        x, z, _ = _arc(mouth, abs(along))
        path.append((np.sign(along) * x, height, front + z))
    return tube(np.array(path), 3.6 * scale, 3.2 * scale, (0, 1.0, 0), around=6)


def with_jaw(teeth_lower: Solid, expression: Expression) -> Array:
    """Vertices of the lower teeth after the jaw's motion."""
    return jaw.turned(teeth_lower.vertices, 1.0, expression)


def tongue(mouth: MouthShape) -> Solid:
    """The tongue at rest: tip first (vertex 0), then rings backwards to the root."""
    scale = _scale(mouth)
    around, rows = 16, 11
    polar = (np.pi * np.arange(1, rows) / rows)[:, None]
    angle = np.linspace(0, 2 * np.pi, around, endpoint=False)[None]
    x = np.sin(polar) * np.cos(angle)
    x = np.sign(x) * np.abs(x) ** 0.9
    y = 6.0 * np.sin(polar) * np.sin(angle)
    z = np.cos(polar) + 0 * angle
    groove = 2.2 * np.exp(-((x / 0.16) ** 2)) * np.sin(polar)
    y = np.where(y > 0, y - groove, y)
    rings = np.stack([16 * x, y, 19 * z], axis=-1)
    ends = np.array([[0, 0, 19.0], [0, 0, -19.0]])
    vertices, triangles = dome(ends[0], rings)
    triangles = np.concatenate(
        [triangles, fan(len(vertices), len(vertices) - around, around)[:, ::-1]]
    )
    vertices = np.vstack([vertices, ends[1]]) * scale
    depth = vertices[:, 2] - 4
    vertices[:, 1] -= 0.010 * depth**2 * np.where(depth > 0, 1.0, 0.3)
    vertices += [0, mouth.height - 7 * scale, mouth.depth - 18.8 - mouth.tooth_back]
    vertices, triangles = outward(vertices, triangles, vertices.mean(axis=0))
    colour = linear((0.82, 0.38, 0.38))
    return Solid("tongue", "tongue", vertices, triangles, colour, shade=0.7, revealed=True)


def tongue_moved(at_rest: Solid, expression: Expression) -> Array:
    """Vertices of the tongue after the jaw's motion; ``expression.tongue`` puts the tip out."""
    places = at_rest.vertices.copy()
    back, front = places[:, 2].min(), places[:, 2].max()
    share = ramp(back, front, places[:, 2])
    # It rises over the lower teeth first.
    rise = min(expression.tongue, _TONGUE_RISE)
    places += share[:, None] * [0, rise + 0.05 * expression.tongue, expression.tongue]
    return jaw.turned(places, _TONGUE_SHARE, expression)
