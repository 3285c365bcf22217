"""The toy: a stitched felt head with button eyes, yarn hair and a ball for a nose. No teeth."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial import cKDTree

from mien.sculpt.acting.expressions import EXAMPLES
from mien.sculpt.acting.repertoire import repertoire
from mien.sculpt.anatomy.bust import bust
from mien.sculpt.anatomy.eyes import catch_light, gaze_frame
from mien.sculpt.anatomy.hair import Scalp, cap, curve, lock
from mien.sculpt.anatomy.head import Head
from mien.sculpt.anatomy.skin import labels
from mien.sculpt.colour import linear, mix, paint_lid_edges, paint_lips, paint_mouth
from mien.sculpt.proportions import (
    Brush,
    EyeShape,
    HairLine,
    HeadShape,
    MouthShape,
    Proportions,
    Temper,
)
from mien.sculpt.sculpture import Sculpture
from mien.sculpt.solid import Form, Solid, ball, fan, merged, outward, sheet, tube

Array = NDArray[np.float64]

_THREAD = (0.62, 0.16, 0.13)
_PATCH, _PATCH_RADII = np.array([50.0, -19.0]), np.array([13.0, 12.0])

_PROPORTIONS = Proportions(
    HeadShape(
        cranium=(1.08, 1.0, 1.0),
        crown=6.0,
        face_width=1.13,
        jaw_width=1.16,
        midface=0.74,
        lower_face=0.86,
        chin_up=4,
        chin_forward=4,
        cheek=9,
        nose=(0.55, 0.40, 0.26),
        nose_up=2,
        neck=0.66,
        brushes=(
            Brush((0, 40, 52), (60, 26, 40), (0, 0, 4)),
            Brush((0, -74, 40), (34, 18, 34), (3, 2, 4)),
            Brush((30, -12, 50), (24, 12, 24), (0, 0, 5)),
        ),
    ),
    EyeShape(
        aside=30.5,
        height=14,
        depth=31,
        radius=24.5,
        half_width=24,
        upper=15.5,
        lower=12,
        tilt=0,
        peak=0,
        lid_turn=5,
        gaze_turn=3,
        crease=7.5,
        offset=4.0,
    ),
    MouthShape(
        half_width=27,
        height=-33,
        depth=60,
        corner_depth=50,
        upper=2.2,
        lower=2.4,
        fullness=1.2,
        bend=5.5,
        tooth_back=13.2,
    ),
    HairLine(brow_up=9.0, brow_width=3.6, brow_height=2.2, brow_inner=4.5, lash=0),
    Temper(brows=1.3, cheeks=0.4, lip_thickness=2.0),
)


def _paint(head: Head) -> Array:
    skin = head.skin
    colours = np.tile(linear((0.91, 0.79, 0.62)), (len(skin), 1))
    patch = np.hypot(
        *((np.abs(skin[:, :2]) * [1, 0] + skin[:, :2] * [0, 1] - _PATCH) / _PATCH_RADII).T
    )
    cheek = np.clip((1.06 - patch) / 0.12, 0, 1) * (skin[:, 2] > 0)
    colours = mix(colours, (0.90, 0.42, 0.36), 0.85 * cheek)
    colours = mix(colours, (0.86, 0.56, 0.48), 0.75 * labels().eye_area)
    colours = paint_lips(colours, (0.70, 0.22, 0.18), 0.9)
    colours = paint_mouth(colours, head, deep=(0.42, 0.07, 0.08))
    return paint_lid_edges(colours, (0.55, 0.36, 0.25))


_BUTTON = (
    (0.30, 0.76), (0.43, 0.775), (0.50, 0.845), (0.57, 0.805), (0.64, 0.745), (0.69, 0.68),
    (0.71, 0.60), (0.71, 0.30),
)  # fmt: skip
"""Radius and height of a button's profile in ball radii: all of it inside the ball, or the lid
passes through it."""
_HOLES = ((0.17, 0.17), (-0.17, 0.17), (-0.17, -0.17), (0.17, -0.17))


def _eyes(eye: EyeShape, side: int) -> Sequence[Solid]:
    """A sewn-on button in a felt socket."""
    frame = gaze_frame(eye, side)
    name = "left" if side > 0 else "right"
    radius = eye.radius
    angle = np.linspace(0, 2 * np.pi, 28, endpoint=False)

    def inside(across: ArrayLike, above: ArrayLike, ahead: ArrayLike) -> Array:
        u, v, w = (
            np.asarray(x, float)[..., None] for x in np.broadcast_arrays(across, above, ahead)
        )
        return np.asarray(frame.centre + radius * (u * frame.out + v * frame.up + w * frame.ahead))

    rings = [inside(r * np.cos(angle), r * np.sin(angle), z * 0.98) for r, z in _BUTTON]
    disc = np.vstack([inside(0.0, 0.0, 0.745)[None], *rings])
    button = np.concatenate([fan(0, 1, len(angle)), sheet(len(_BUTTON), len(angle), 1)])
    felt, felt_faces = ball(frame.centre, 0.97 * radius, 20)
    beyond = np.clip((felt - frame.centre) @ frame.ahead - 0.5 * radius, 0, None)
    felt = felt - beyond[:, None] * frame.ahead
    holes = merged([ball(inside(u, v, 0.75), 0.075 * radius, 8) for u, v in _HOLES])
    ends = [inside(u, v, 0.76) for u, v in _HOLES]
    crossed = merged(
        [_stitch(ends[a], ends[b], frame.ahead, 1.15, 1.6) for a, b in ((0, 2), (1, 3))]
    )
    turns = f"eye_{name}"
    return (
        Solid(
            turns,
            "button",
            *outward(disc, button, frame.centre),
            linear((0.10, 0.30, 0.46)),
            turns,
            0.7,
        ),
        Solid(f"socket_{name}", "felt", felt, felt_faces, linear((0.42, 0.27, 0.18)), turns, 0.8),
        Solid(f"holes_{name}", "felt", *holes, linear((0.03, 0.06, 0.09)), turns, 0.0),
        Solid(f"thread_{name}", "yarn", *crossed, linear((0.93, 0.86, 0.72)), turns, 0.3),
        catch_light(eye, side, 0.10, (-0.42, 0.46), -0.02 * radius, second=False),
    )


def _stitch(start: Array, end: Array, up: Array, radius: float, rise: float = 0.6) -> Form:
    along = np.linspace(0, 1, 6)[:, None]
    arch = rise * 1.2 * np.sin(np.pi * along) - 0.2
    path = start * (1 - along) + end * along + up * arch
    profile = radius * np.clip(np.minimum(along, 1 - along)[:, 0] / 0.12, 0.35, 1)
    return tube(path, profile, profile, up, around=5)


def _hair(neutral: Head) -> Solid:
    """Yarn: even strands in two layers, over a cap."""
    scalp = Scalp(neutral.skin)
    random = np.random.default_rng(5)
    forms: list[Form] = []

    def strand(course: Sequence[tuple[float, float, float]], radius: float) -> None:
        forms.append(
            lock(scalp, course, radius, radius, rows=9, around=5, widest=0.2, start=0.9, end=0.75)
        )

    for count, top, end, above in ((17, 80, 26, 7), (13, 72, 40, 11)):
        for yaw in np.linspace(-60, 60, count):
            a, b, c, d = random.normal(0, 1, 4)
            low, out = end - 0.12 * abs(yaw) + 3 * b, 1.05 * yaw + 3 * a
            strand(
                [
                    (0.35 * yaw, top, 5),
                    (0.75 * yaw, (top + low) / 2 + 8, above + 1),
                    (out, low + 12, above + 2),
                    (out + 3 * c, low, above - 1),
                    (out + 4 * c + 2, low - 4, above - 4),
                ],
                4.3,
            )
    for side in (1, -1):
        for row, (above, end) in enumerate(((7, -34), (12, -26))):
            for yaw in np.linspace(62, 178, 17):
                a, b, c, d = random.normal(0, 1, 4)
                if yaw < 66 and row == 1:
                    continue
                low = end + 4 * a + (10 if 70 < yaw < 100 else 0)
                strand(
                    [
                        (0.5 * side * yaw, 84, 5),
                        (0.9 * side * yaw, 52, above + 1),
                        (side * (yaw + 2 * b), 18, above + 2),
                        (side * (yaw + 2 * c), -8, above + 2),
                        (side * (yaw + 3 * d), low, above + 1 + b),
                    ],
                    4.6,
                )
    edge = curve((0, 70), (40, 72), (60, 78), (90, 100), (180, 116))
    under, _ = cap(scalp, edge, lambda azimuth, along: 5 + 0 * along, around=40, rows=9)
    form = merged([*forms, under])
    twist = np.clip(0.55 + 0.45 * np.sin(form[0] @ [0.9, 0.8, 0.7]), 0, 1)[:, None]
    colours = linear((0.62, 0.20, 0.07)) * (1 - twist) + linear((0.93, 0.46, 0.16)) * twist
    return Solid("hair", "yarn", *form, colours)


def _bow() -> Solid:
    """A neckerchief: a felt ring and a bow."""
    angle = np.linspace(0, 2 * np.pi, 32)
    ring = np.stack(
        [44 * np.sin(angle), -101 - 5 * np.cos(angle), -58 + 44 * np.cos(angle)], axis=1
    )
    around = np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=1)
    forms = [tube(ring, 9.0, 6.0, around, 8), ball((0, -106, -1), (7.5, 8.5, 6.5), 14)]
    along = np.linspace(0, 1, 10)
    flare = 5 + 11 * along**0.8 * np.sqrt(np.clip((1.02 - along) / 0.12, 0, 1))
    for side in (1, -1):
        path = np.stack(
            [
                side * (3 + 34 * along),
                -106 + 4 * np.sin(3 * along) + 2 * along,
                -4 + 3 * np.sin(np.pi * along),
            ],
            axis=1,
        )
        forms.append(tube(path, flare, 3.2 + 3 * np.sin(np.pi * along), (0, 0, 1.0), 10))
    return Solid("bow", "cloth", *merged(forms), linear((0.86, 0.62, 0.16)), follows="body")


def _dress(neutral: Head) -> Sequence[Solid]:
    return _hair(neutral), bust((0.22, 0.42, 0.46), (0.92, 0.84, 0.68), narrow=0.9), _bow()


def _sewn(neutral: Head) -> tuple[Form, Form]:
    """Stitches at the mouth and round the cheek patches, and the seam on the forehead."""
    on_face = np.flatnonzero((labels().mask > 0.6) & (labels().bag < 0.2))
    tree = cKDTree(neutral.skin[on_face, :2])

    def on_skin(x: float, y: float) -> tuple[Array, Array]:
        apart, near = tree.query([x, y], k=5)
        weight = 1 / (apart + 0.5) ** 2
        weight = (weight / weight.sum())[:, None]
        up = (neutral.normals[on_face[near]] * weight).sum(axis=0)
        place = (neutral.skin[on_face[near]] * weight).sum(axis=0)
        return place + 0.4 * up, up / np.linalg.norm(up)

    def stitch(x0: float, y0: float, x1: float, y1: float, radius: float) -> Form:
        (start, up), (end, also_up) = on_skin(x0, y0), on_skin(x1, y1)
        return _stitch(start, end, (up + also_up) / 2, radius)

    mouth = neutral.proportions.mouth
    corner, level = mouth.half_width + 3.5, mouth.height + mouth.bend
    patches: list[Form] = []
    for side in (1, -1):
        patches.append(stitch(side * corner, level + 5.5, side * (corner + 3), level - 4, 1.3))
        for angle in np.linspace(0, 2 * np.pi, 10, endpoint=False):
            (x0, y0), (x1, y1) = (
                _PATCH + (_PATCH_RADII + 0.5) * [np.cos(a), np.sin(a)]
                for a in (angle, angle + 0.38)
            )
            patches.append(stitch(side * x0, y0, side * x1, y1, 0.85))
    seam = [stitch(-4.2, y - 1.5, 4.2, y + 1.5, 0.95) for y in np.linspace(88, 30, 9)]
    return merged(patches), merged(seam)


def _carried(places: Array, neutral: Head, posed: Head, near: int) -> Array:
    """``places`` moved as the ``near`` skin vertices next to each move."""
    outside = np.flatnonzero(labels().bag < 0.3)
    apart, found = cKDTree(neutral.skin[outside]).query(places, k=near)
    weight = 1 / (apart + 0.8) ** 2
    weight /= weight.sum(axis=1, keepdims=True)
    motion = (posed.skin - neutral.skin)[outside[found]]
    return np.asarray(places + (motion * weight[..., None]).sum(axis=1))


def _ride(neutral: Head, posed: Head) -> Sequence[Solid]:
    (patches, patch_faces), (seam, seam_faces) = _sewn(neutral)
    eye, mouth = neutral.proportions.eye, neutral.proportions.mouth
    nose, nose_faces = ball((0, eye.height - 19, mouth.depth + 4), (11, 9.5, 9.5), 16)
    # The ball is hard: it goes along as a whole.
    pushed = (_carried(nose, neutral, posed, 30) - nose).mean(axis=0)
    return (
        Solid(
            "stitches",
            "yarn",
            _carried(patches, neutral, posed, 4),
            patch_faces,
            linear(_THREAD),
            shade=0.3,
        ),
        Solid(
            "seam",
            "yarn",
            _carried(seam, neutral, posed, 4),
            seam_faces,
            linear((0.70, 0.52, 0.36)),
            shade=0.3,
        ),
        Solid("nose", "felt", nose + pushed, nose_faces, linear((0.84, 0.26, 0.20))),
    )


# Wide-open lids would show where a button ends, and strong squints crumple the felt.
_KEYS = repertoire(
    smile={"corner": (10.0, 11.0, -5.0), "squint": 0.25},
    sad={"corner": (-1.0, -10.0, -1.0)},
    pressed={"upper_thick": 0.75, "lower_thick": 0.75},
    laugh={"squint": 0.35},
    sneer_left={"nose": 3.5},
    sneer_right={"nose": 3.5},
    surprise={"blink": -0.2, "squint": -0.1},
    fear={"blink": -0.18},
    disgust={"squint": 0.3},
    anger={"squint": 0.25, "brow_inner": (-4.5, -9.0, 2.5), "brow_outer": (0, 5.0, 0)},
)

TOY = Sculpture(
    name="toy",
    proportions=_PROPORTIONS,
    paint=_paint,
    eyes=_eyes,
    dress=_dress,
    keys=_KEYS,
    examples=EXAMPLES,
    brow=(0.55, 0.17, 0.07),
    teeth=False,
    skin="felt",
    ride=_ride,
)
