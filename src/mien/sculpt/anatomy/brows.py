"""Brows and lashes: hair that is rebuilt on the skin in every pose."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from mien.sculpt.acting.pose import lid_pose
from mien.sculpt.anatomy.head import Head
from mien.sculpt.anatomy.lids import eye_frame, margin, on_ball
from mien.sculpt.anatomy.skin import labels
from mien.sculpt.solid import Form, sheet, spline, tube
from mien.vocabulary import topology

Array = NDArray[np.float64]

_BROW_ROWS, _LASH_ROWS = 14, 20
_FIRST_LASH = 0.9
"""Position on the lid loop where lashes begin, from the inner corner."""


def brow(head: Head) -> Form:
    """The left brow: a flattened tube, blunt inside, tapered outside, laid on the skin."""
    hair = head.proportions.hair_line
    upper, lower = head.cage[topology.BROW_UPPER], head.cage[topology.BROW_LOWER]
    share = hair.brow_between
    lift = hair.brow_up + hair.brow_inner * np.linspace(1, 0, len(upper))[:, None] ** 1.5
    path = spline(upper * share + lower * (1 - share) + lift * [0, 1, 0], _BROW_ROWS)
    on_mask = np.flatnonzero(labels().mask > 0.5)
    distance, near = cKDTree(head.skin[on_mask]).query(path, k=6)
    weight = 1 / (distance + 1.5) ** 2
    weight = (weight / weight.sum(axis=1, keepdims=True))[..., None]
    up = (head.normals[on_mask[near]] * weight).sum(axis=1)
    up /= np.linalg.norm(up, axis=1, keepdims=True)
    ground = (head.skin[on_mask[near]] * weight).sum(axis=1)
    path = path + up * ((ground - path) * up).sum(axis=1)[:, None]
    along = np.linspace(0, 1, _BROW_ROWS)
    profile = np.sqrt(np.clip(along / 0.10, 0, 1))
    profile = profile * (0.80 + 0.45 * np.exp(-(((along - 0.35) / 0.3) ** 2)))
    profile *= 1 - 0.86 * np.clip((along - 0.45) / 0.55, 0, 1) ** 1.6
    profile = np.maximum(profile * np.sqrt(np.clip((1 - along) / 0.03, 0, 1)), 0.04)
    thick = hair.brow_height * np.clip(1.2 * profile, 0.1, 1)
    return tube(path + 0.7 * up, hair.brow_width * profile, thick, up)


def lashes(head: Head, side: int) -> Form:
    """A wedge along the upper lid's margin, longer towards the outer corner."""
    eye, hair = head.proportions.eye, head.proportions.hair_line
    pose = lid_pose(head.expression, side)
    across, above = margin(eye, pose)
    inner_to_outer = np.arange(8, -1, -1)
    at = np.linspace(_FIRST_LASH, 8.0, _LASH_ROWS)
    u = CubicSpline(np.arange(9), across[inner_to_outer])(at)
    v = CubicSpline(np.arange(9), above[inner_to_outer])(at)
    along = np.linspace(0, 1, _LASH_ROWS)
    length = hair.lash * (0.25 + 0.75 * along**1.2) * np.clip(along / 0.2, 0.02, 1) ** 0.8
    length = length * np.clip((1 - along) / 0.04, 0.55, 1)
    aside = 0.9 * along**2
    lift = 0.55 * (1 - 1.5 * pose.upper) - 0.1 * along
    rest = eye.radius + eye.offset
    root = on_ball(eye, side, u, v - 0.2, rest - 1.0)
    edge = on_ball(eye, side, u, v + hair.lash_width * np.clip(along / 0.25, 0, 1), rest + 0.55)
    frame = eye_frame(eye, side, eye.lid_turn)
    out = root - frame.centre
    out /= np.linalg.norm(out, axis=1, keepdims=True)
    reach = np.hypot(aside, lift) + 1e-6
    tip = root + length[:, None] * (
        0.85 * out + frame.out * (0.7 * aside / reach)[:, None] + frame.up * (0.9 * lift)[:, None]
    )
    rows = np.stack([root, tip, edge, root])
    strip = sheet(4, _LASH_ROWS, closed=False)
    # The last row is the first again: a closed wedge.
    strip = np.where(strip >= 3 * _LASH_ROWS, strip - 3 * _LASH_ROWS, strip)
    return rows[:3].reshape(-1, 3), strip if side > 0 else strip[:, ::-1]
