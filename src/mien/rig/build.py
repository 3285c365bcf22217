"""A model becomes a character: head frame, parts, feature points, key models."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.errors import InputError
from mien.face.character import Character, KeyModels
from mien.face.face import Array, Face, FeaturePoints, Ints, Material
from mien.face.model import Model
from mien.face.origin import Origin
from mien.formats.gltf.eyes import with_eye_nodes
from mien.rig.completion import LIDS, balanced, mirrored, on_surface, warped, with_pupils
from mien.rig.components import Ball, components, find_ball
from mien.rig.dress import dressed
from mien.rig.openings import margins
from mien.rig.parts import EYES, parts_of
from mien.rig.picks import Picks
from mien.rig.settle import settle
from mien.vocabulary.fdp import feature_points

_MATERIALS = {
    "skin": Material(roughness=0.6, specular=0.35, subsurface=0.6),
    "eye": Material(roughness=0.15, specular=0.8),
    "other": Material(roughness=0.7, specular=0.25),
}
_CARRIED_AWAY = 0.6
"""Widths from eye to eye: what carries a thing as far hides it, and is no expression."""
_NEAR_DECAL = 0.15
"""Widths from eye to eye within which a piece on the face takes a feature point."""
_DECALS = (
    *(("4.1", "4.3", "4.5"), ("4.2", "4.4", "4.6")),
    *((f"{group}.{index}",) for group, last in ((3, 14), (8, 10)) for index in range(1, last + 1)),
    *((f"2.{index}",) for index in range(2, 10)),
)
"""Feature points that may lie on pieces of their own: brows, eyes and lips, but no nose."""
PUPILS = 63.0
"""mm between the pupils of a face whose size does not count."""


@dataclass(frozen=True, slots=True)
class Upright:
    """A way from a file into millimetres, upright and facing +z, its middle at x = 0."""

    facing: int
    scale: float
    middle: float

    @property
    def turn(self) -> Array:
        """(3, 3) upright_from_file, a rotation."""
        return np.diag([self.facing, 1.0, self.facing]).astype(float)

    def __call__(self, places: Array) -> Array:
        away = places - np.array([self.middle, 0.0, 0.0])
        return np.asarray(away @ self.turn.T * self.scale)

    def back(self, places: Array) -> Array:
        """``places`` (..., 3) in the file again."""
        return np.asarray(places @ self.turn / self.scale + np.array([self.middle, 0.0, 0.0]))


def build(model: Model, picks: Picks, unit: float | None, *, seen: bool = False) -> Character:
    """``picks`` in the model's coordinates, ``unit`` millimetres in one of its units, None for a
    face whose size does not count; ``seen`` where they were found by looking and the shapes may
    know better. Raises InputError where the picks cannot be a face's."""
    upright = _upright(model, picks, unit)
    vertices, triangles = upright(model.vertices), model.triangles
    names, fields = _fields(model, upright)
    whole = mirrored({name: upright(place) for name, place in picks.items()})
    part = components(vertices, triangles)
    skin = _skin(vertices, triangles, part, whole)
    balls = _balls(vertices, part, whole)
    on_skin = np.unique(skin).astype(np.intp)
    acting = on_skin if fields[:, on_skin].any() else np.arange(len(vertices))
    if seen:
        whole = settle(balanced(whole), vertices[acting], fields[:, acting], lids=balls is None)
        whole |= _margins(vertices, triangles, on_skin, balls, whole)
    places, pivots = warped(whole)
    places = settle(places, vertices[acting], fields[:, acting], lids=False, sure=whole)
    points = _on_face(places, vertices, triangles, skin, part, fields)
    points, pivots = _with_eyes(points, pivots, vertices, triangles, balls)
    if balls is not None and model.hooks.vrm is None and model.hooks.eyes == (None, None):
        centres = [upright.back(ball.centre) for ball in balls]
        model = with_eye_nodes(model, [ball.vertices for ball in balls], centres)
    if model.head_place is not None:
        pivots["head"] = upright(model.head_place)
    origin = (pivots["eye_left"] + pivots["eye_right"]) / 2.0
    order, parts = parts_of(model, part, vertices, skin, balls, float(pivots["head"][1]))
    colours = np.concatenate([part.colours for part in model.parts])
    row = np.empty(len(order), dtype=np.int32)
    row[order] = np.arange(len(order), dtype=np.int32)
    face = Face(
        vertices=(vertices - origin)[order],
        parts=tuple(replace(p, triangles=row[p.triangles]) for p in parts),
        materials=_MATERIALS,
        colours=dressed(colours, vertices, balls or ())[order],
        occlusion=np.ones(len(order)),
        points=FeaturePoints(points.ids, row[points.vertices], points.weights),
        pivots={name: place - origin for name, place in pivots.items()},
    )
    return Character(
        name=model.name,
        face=face,
        keys=KeyModels(names, np.ascontiguousarray(fields[:, order])),
        examples=names,
        whole=True,
        blinks=frozenset(),
        origin=_origin(model, upright, origin, order),
    )


def _on_face(
    places: dict[str, Array],
    vertices: Array,
    triangles: Ints,
    skin: Ints,
    part: NDArray[np.intp],
    fields: NDArray[np.float32],
) -> FeaturePoints:
    """The feature points, dropped onto ``skin`` (T, 3) or what is drawn on it."""
    points = on_surface(places, vertices, skin)
    if fields[:, np.unique(skin)].any():
        return points
    return _on_decals(points, places, vertices, triangles, part, fields)


def _with_eyes(
    points: FeaturePoints,
    pivots: dict[str, Array],
    vertices: Array,
    triangles: Ints,
    balls: tuple[Ball, Ball] | None,
) -> tuple[FeaturePoints, dict[str, Array]]:
    """Pupils on the eyeballs, and what the eyes turn about."""
    if balls is not None:
        eyes = balls[0].vertices | balls[1].vertices
        centres = {eye: ball.centre for eye, ball in zip(EYES, balls, strict=True)}
        return with_pupils(points, vertices, triangles, eyes), pivots | centres
    at, centres = points.at(vertices), {}
    for eye, lids in zip(EYES, LIDS, strict=True):
        corners = at[points.index(lids)]
        # An eye without a ball of its own turns half its width behind its lids.
        depth = float(np.linalg.norm(corners[0] - corners[1])) / 2.0
        centres[eye] = corners.mean(axis=0) - np.array([0.0, 0.0, depth])
    return points, pivots | centres


def _on_decals(
    points: FeaturePoints,
    places: dict[str, Array],
    vertices: Array,
    triangles: Ints,
    part: NDArray[np.intp],
    fields: NDArray[np.float32],
) -> FeaturePoints:
    """Points moved from a still head onto eyes, brows and lips that lie on it as pieces of their
    own, where such a piece is near; all of a brow onto one piece, for lashes come near it too."""
    left, right = points.at(vertices)[points.index(("3.7", "3.12"))]
    apart = float(np.linalg.norm(left - right))
    sane = np.abs(fields).max(axis=(1, 2)) < _CARRIED_AWAY * apart
    length = np.abs(fields[sane]).max(axis=(0, 2), initial=0.0)
    acting = triangles[(length > 0)[triangles].any(axis=1)]
    if not len(acting):
        return points
    corners, weights = points.vertices.copy(), points.weights.copy()
    for names in _DECALS:
        wanted = {name: places[name] for name in names if name in places}
        if not wanted:
            continue
        target = np.stack(list(wanted.values()))
        pieces = [acting]
        if len(names) > 1:
            pieces = [acting[part[acting[:, 0]] == n] for n in np.unique(part[acting[:, 0]])]
        found = [on_surface(wanted, vertices, piece) for piece in pieces]
        away = np.stack([np.linalg.norm(f.at(vertices) - target, axis=1) for f in found])
        best = int(away.sum(axis=1).argmin())
        near = away[best] < _NEAR_DECAL * apart
        rows = points.index(tuple(wanted))[near]
        corners[rows], weights[rows] = found[best].vertices[near], found[best].weights[near]
    return FeaturePoints(points.ids, corners, weights)


def _upright(model: Model, picks: Picks, unit: float | None) -> Upright:
    middles = [place[0] for name, place in picks.items() if _is_middle(name)]
    upright = Upright(facing(picks), 1.0, float(np.mean(middles)))
    for name in ("3.7", "3.12"):
        if name in picks and upright(picks[name])[0] * (1 if name == "3.7" else -1) <= 0:
            raise InputError(
                f"{model.name}: {name} lies on the subject's {'right' if name == '3.7' else 'left'}"
                ": left and right are the subject's own; swap the points' sides"
            )
    if unit is None:
        unit = PUPILS / pupils_apart(picks)
    return replace(upright, scale=unit)


def facing(picks: Picks) -> int:
    """1 for a face that looks to +z, -1 for one that looks to -z: noses stick out."""
    eyes = [picks[name][2] for lids in LIDS for name in lids if name in picks]
    nose = picks["9.3"] if "9.3" in picks else picks["9.15"]
    return 1 if nose[2] >= np.mean(eyes) else -1


def pupils_apart(picks: Picks) -> float:
    """Distance between the middles of the eyes, in the picks' unit."""
    middle = float(np.mean([place[0] for name, place in picks.items() if _is_middle(name)]))
    aside = [
        abs(np.mean([picks[n][0] for n in lids if n in picks]) - middle)
        for lids in LIDS
        if any(n in picks for n in lids)
    ]
    return float(2.0 * np.mean(aside))


def _is_middle(name: str) -> bool:
    return feature_points()[name].mirror == name


def _balls(vertices: Array, part: NDArray[np.intp], picks: Picks) -> tuple[Ball, Ball] | None:
    found = [
        find_ball(vertices, part, np.stack([picks[name] for name in lids]))
        if all(name in picks for name in lids)
        else None
        for lids in LIDS
    ]
    left, right = found
    return None if left is None or right is None else (left, right)


def _margins(
    vertices: Array,
    triangles: Ints,
    skin: NDArray[np.intp],
    balls: tuple[Ball, Ball] | None,
    picks: Picks,
) -> dict[str, Array]:
    """The lid margins of eyes that have balls."""
    found: dict[str, Array] = {}
    for (outer, inner, upper, lower), ball in zip(LIDS, balls or (), strict=False):
        width = float(np.linalg.norm(picks[outer] - picks[inner]))
        places = margins(vertices, triangles, skin, ball, width)
        if places is not None:
            found[upper], found[lower] = places
    return found


def _skin(vertices: Array, triangles: Ints, part: NDArray[np.intp], picks: Picks) -> Ints:
    """Triangles of the connected part on which most of the picks lie."""
    places = {name: place for name, place in picks.items() if name not in ("3.5", "3.6")}
    on = on_surface(places, vertices, triangles)
    most = np.bincount(part[on.vertices[:, 0]]).argmax()
    return np.asarray(triangles[part[triangles[:, 0]] == most])


def _fields(model: Model, upright: Upright) -> tuple[tuple[str, ...], NDArray[np.float32]]:
    """Names (K) and displacements (K, V, 3) in an order of their content, so that nothing hangs on
    names or on the order in which a file lists its shapes."""
    turn = (upright.turn.T * upright.scale).astype(np.float32)
    fields = {s.name: np.ascontiguousarray(model.dense(s) @ turn) for s in model.shapes if s.fields}
    names = sorted(fields, key=lambda name: hashlib.sha256(fields[name].tobytes()).digest())
    if not names:
        return (), np.zeros((0, len(model.vertices), 3), np.float32)
    return tuple(names), np.stack([fields[name] for name in names])


def _origin(
    model: Model, upright: Upright, origin: Array, order: NDArray[np.intp]
) -> Origin | None:
    if model.source is None:
        return None
    return Origin(
        glb=model.source,
        binds={shape.name: shape.binds for shape in model.shapes},
        hooks=model.hooks,
        turn=upright.turn.T,
        scale=upright.scale,
        centre=upright.back(origin),
        expressions={s.name: s.expression for s in model.shapes if s.expression},
        overrides=model.overrides,
        order=order.astype(np.int32),
    )
