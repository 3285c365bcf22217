"""The energy of a lens and its exact gradient, [B] eqs. 2-4.

    symbol      here
    v(s)        upper or lower curve, at SAMPLES parameters each
    E_image     -w1 max(0, dI/dn)^2, the slope of I along the inward normal n        eq. 3
    E_con       wout I(v - reach n) - win I(v + reach n)                             eq. 4
    E           mean over the samples of both curves of E_image + E_con, plus priors eq. 2

Two changes to the paper. Only edges of the right sign count: dark-to-light edges beside a feature
(a glint, the far side of a lash) are as sharp as its own outline. The offset curves lie along the
normal, not along the head's up-vector, so that they serve the corners too.

Priors are one quadratic form in the lens's twelve numbers, x' Q x - 2 b' x, and two hinges: the
lower curve stays below the upper one, and the lens keeps a least width.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numba import njit
from numpy.typing import NDArray

from mien.capture.snakes.curves.lens import LOWER, UPPER
from mien.numeric.bezier import bernstein, bernstein_slope

Array = NDArray[np.float64]
Field = NDArray[np.float32]

SAMPLES = 14
_AT = (np.arange(SAMPLES) + 0.5) / SAMPLES
_B, _SLOPE = bernstein(_AT), bernstein_slope(_AT)
_CURVES = np.stack([UPPER, LOWER])

HALF_STEP = 1.0
"""Patch units to each side over which the slope across the curve is taken."""
_CROSSING = 0.02
_NARROW = 0.01


@dataclass(frozen=True, slots=True)
class Terms:
    """What is weighed against what in one descent."""

    edge: float = 1.0
    """w1"""
    outside: float = 1.0
    """wout"""
    inside: float = 1.0
    """win"""
    reach: float = 2.0
    """Patch units from the curve to its offset curves."""
    least_width: float = 0.0
    pitch: float = 1.0
    """Patch units from one pixel of the field to the next."""


def energy(
    lens: Array, field: Field, corner: Array, terms: Terms, quadratic: Array, linear: Array
) -> tuple[float, Array]:
    """E and its gradient (6, 2) of ``lens`` (6, 2) on ``field`` (H, W), whose first pixel's
    centre is at ``corner`` (2,); ``quadratic`` (12, 12) symmetric and ``linear`` (12,)."""
    gradient = np.empty(12)
    value = evaluate(lens.reshape(12), field, corner, packed(terms), quadratic, linear, gradient)
    return float(value), gradient.reshape(6, 2)


def packed(terms: Terms) -> Array:
    """The numbers of ``terms`` as the kernels take them."""
    return np.array(
        [
            terms.edge,
            terms.outside,
            terms.inside,
            terms.reach,
            terms.least_width,
            terms.pitch,
        ]
    )


@njit(cache=True, nogil=True, fastmath=True)
def _look(field: Field, x: float, y: float, grain: float) -> tuple[float, float, float]:
    """Bilinear value of the field and its slopes by x and y, ``grain`` pixels a unit; beyond its
    rim it goes on level."""
    rows, columns = field.shape
    x, y = x * grain, y * grain
    inside_x = 0.0 <= x <= columns - 1.000001
    inside_y = 0.0 <= y <= rows - 1.000001
    x = min(max(x, 0.0), columns - 1.000001)
    y = min(max(y, 0.0), rows - 1.000001)
    column, row = int(x), int(y)
    fx, fy = x - column, y - row
    a, b = field[row, column], field[row, column + 1]
    c, d = field[row + 1, column], field[row + 1, column + 1]
    above, below = a + fx * (b - a), c + fx * (d - c)
    slope_x = ((b - a) + fy * ((d - c) - (b - a))) if inside_x else 0.0
    slope_y = (below - above) if inside_y else 0.0
    return above + fy * (below - above), slope_x * grain, slope_y * grain


@njit(cache=True, nogil=True, fastmath=True)
def evaluate(
    lens: Array,
    field: Field,
    corner: Array,
    terms: Array,
    quadratic: Array,
    linear: Array,
    gradient: Array,
) -> float:
    """E; its gradient (12,) is written into ``gradient``."""
    edge, outside, inside, reach, least = terms[0], terms[1], terms[2], terms[3], terms[4]
    grain = 1.0 / terms[5]
    total = 0.0
    for i in range(12):
        row = 0.0
        for j in range(12):
            row += quadratic[i, j] * lens[j]
        total += lens[i] * (row - 2.0 * linear[i])
        gradient[i] = 2.0 * (row - linear[i])
    share = 1.0 / (2 * SAMPLES)
    for k in range(SAMPLES):
        apart = 0.0
        for c in range(2):
            x = y = u = v = 0.0
            for p in range(4):
                px, py = lens[2 * _CURVES[c, p]], lens[2 * _CURVES[c, p] + 1]
                x += _B[k, p] * px
                y += _B[k, p] * py
                u += _SLOPE[k, p] * px
                v += _SLOPE[k, p] * py
            length = max(np.sqrt(u * u + v * v), 1e-6)
            tx, ty = u / length, v / length
            sign = 1.0 if c == 0 else -1.0
            nx, ny = -sign * ty, sign * tx
            apart += y if c == 1 else -y
            x0, y0 = x - corner[0], y - corner[1]
            near, near_x, near_y = _look(field, x0 + HALF_STEP * nx, y0 + HALF_STEP * ny, grain)
            far, far_x, far_y = _look(field, x0 - HALF_STEP * nx, y0 - HALF_STEP * ny, grain)
            into, into_x, into_y = _look(field, x0 + reach * nx, y0 + reach * ny, grain)
            away, away_x, away_y = _look(field, x0 - reach * nx, y0 - reach * ny, grain)
            slope = max((near - far) / (2.0 * HALF_STEP), 0.0)
            total += share * (outside * away - inside * into - edge * slope * slope)
            pull = -edge * slope / HALF_STEP
            # By the place on the curve, and by the normal.
            gx = outside * away_x - inside * into_x + pull * (near_x - far_x)
            gy = outside * away_y - inside * into_y + pull * (near_y - far_y)
            mx = pull * HALF_STEP * (near_x + far_x) - reach * (outside * away_x + inside * into_x)
            my = pull * HALF_STEP * (near_y + far_y) - reach * (outside * away_y + inside * into_y)
            # The normal turns with the tangent: dn = t (J dt . t) / |dt|, J a quarter turn.
            turn = sign * (mx * tx + my * ty) / length
            for p in range(4):
                i = 2 * _CURVES[c, p]
                gradient[i] += share * (_B[k, p] * gx + _SLOPE[k, p] * turn * ty)
                gradient[i + 1] += share * (_B[k, p] * gy - _SLOPE[k, p] * turn * tx)
        if apart < 0.0:
            total += _CROSSING * apart * apart / SAMPLES
            for p in range(4):
                bend = 2.0 * _CROSSING * apart / SAMPLES * _B[k, p]
                gradient[2 * _CURVES[1, p] + 1] += bend
                gradient[2 * _CURVES[0, p] + 1] -= bend
    missing = least - (lens[2] - lens[0])
    if missing > 0.0:
        total += _NARROW * missing * missing
        gradient[0] += 2.0 * _NARROW * missing
        gradient[2] -= 2.0 * _NARROW * missing
    return total


@njit(cache=True, nogil=True, fastmath=True)
def descend(
    lens: Array,
    field: Field,
    corner: Array,
    terms: Array,
    quadratic: Array,
    linear: Array,
    steps: int,
    first_step: float,
) -> tuple[Array, float]:
    """Downhill along the gradient: a step that lowers E makes the next one longer, one that does
    not is taken back and halved. ``lens`` (12,); ``first_step`` is how far the lens's fastest
    coordinate goes at first, patch units."""
    place, trial = lens.copy(), np.empty(12)
    gradient, ahead = np.empty(12), np.empty(12)
    value = evaluate(place, field, corner, terms, quadratic, linear, gradient)
    step = first_step
    for _ in range(steps):
        steepest = 1e-12
        for i in range(12):
            steepest = max(steepest, abs(gradient[i]))
        for i in range(12):
            trial[i] = place[i] - step / steepest * gradient[i]
        there = evaluate(trial, field, corner, terms, quadratic, linear, ahead)
        if there < value:
            value = there
            place, trial = trial, place
            gradient, ahead = ahead, gradient
            step *= 1.3
        else:
            step *= 0.5
            if step < 0.02:
                break
    return place, value
