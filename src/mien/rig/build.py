"""A model becomes a character: head frame, parts, feature points, key models."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from mien.errors import InputError
from mien.face.character import Character, KeyModels
from mien.face.face import Array, Face, FeaturePoints, Ints, Material, Part
from mien.face.model import Model
from mien.face.origin import Origin
from mien.rig.completion import LIDS, mirrored, on_surface, warped, with_pupils
from mien.rig.components import Ball, components, find_ball
from mien.rig.picks import Picks
from mien.vocabulary.fdp import feature_points

_MATERIALS = {
    "skin": Material(roughness=0.6, specular=0.35, subsurface=0.6),
    "eye": Material(roughness=0.15, specular=0.8),
    "other": Material(roughness=0.7, specular=0.25),
}
_EYES = ("eye_left", "eye_right")
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


def build(model: Model, picks: Picks, unit: float | None) -> Character:
    """``picks`` in the model's coordinates, ``unit`` millimetres in one of its units, None for a
    face whose size does not count. Raises InputError where the picks cannot be a face's."""
    upright = _upright(model, picks, unit)
    whole = mirrored({name: upright(place) for name, place in picks.items()})
    vertices, triangles = upright(model.vertices), model.triangles
    part = components(vertices, triangles)
    balls = _balls(vertices, part, whole)
    skin = _skin(vertices, triangles, part, whole)
    places, pivots = warped(whole)
    points = on_surface(places, vertices, skin)
    eyes = None if balls is None else balls[0].vertices | balls[1].vertices
    points = with_pupils(points, vertices, triangles, eyes)
    if balls is None:
        at = points.at(vertices)
        pivots |= {
            eye: at[points.index(lids)].mean(axis=0) - [0.0, 0.0, _behind(at, points, lids)]
            for eye, lids in zip(_EYES, LIDS, strict=True)
        }
    else:
        pivots |= {eye: ball.centre for eye, ball in zip(_EYES, balls, strict=True)}
    origin = (pivots["eye_left"] + pivots["eye_right"]) / 2.0
    order, parts = _parts(model, part, skin, balls)
    row = np.empty(len(order), dtype=np.int32)
    row[order] = np.arange(len(order), dtype=np.int32)
    face = Face(
        vertices=(vertices - origin)[order],
        parts=tuple(replace(p, triangles=row[p.triangles]) for p in parts),
        materials=_MATERIALS,
        colours=np.concatenate([p.colours for p in model.parts])[order],
        occlusion=np.ones(len(order)),
        points=FeaturePoints(points.ids, row[points.vertices], points.weights),
        pivots={name: place - origin for name, place in pivots.items()},
    )
    keys = _keys(model, upright, order)
    return Character(
        name=model.name,
        face=face,
        keys=keys,
        examples=keys.names,
        whole=True,
        blinks=frozenset(),
        origin=_origin(model, upright, origin),
    )


def _upright(model: Model, picks: Picks, unit: float | None) -> Upright:
    eyes = [picks[name] for lids in LIDS for name in lids if name in picks]
    nose = picks.get("9.3", picks.get("9.15"))
    assert nose is not None
    facing = 1 if nose[2] >= np.mean(eyes, axis=0)[2] else -1
    middles = [place[0] for name, place in picks.items() if _is_middle(name)]
    upright = Upright(facing, 1.0, float(np.mean(middles)))
    for name in ("3.7", "3.12"):
        if name in picks and upright(picks[name])[0] * (1 if name == "3.7" else -1) <= 0:
            raise InputError(
                f"{model.name}: {name} lies on the subject's {'right' if name == '3.7' else 'left'}"
                ": left and right are the subject's own; swap the points' sides"
            )
    if unit is None:
        apart = 2.0 * abs(upright(np.mean(eyes[: max(1, len(eyes))], axis=0))[0])
        both = {n for n in picks if n in LIDS[0]} and {n for n in picks if n in LIDS[1]}
        if both:
            left, right = (
                np.mean([upright(picks[n]) for n in lids if n in picks], axis=0) for lids in LIDS
            )
            apart = float(abs(left - right)[0])
        unit = PUPILS / apart
    return replace(upright, scale=unit)


def _is_middle(name: str) -> bool:
    return feature_points()[name].mirror == name


def _behind(at: Array, points: FeaturePoints, lids: tuple[str, ...]) -> float:
    """How far behind its lids an eye turns that has no ball of its own: half its width."""
    outer, inner = points.index(lids[:2])
    return float(np.linalg.norm(at[outer] - at[inner])) / 2.0


def _balls(vertices: Array, part: NDArray[np.intp], picks: Picks) -> tuple[Ball, Ball] | None:
    found = [
        find_ball(vertices, part, np.stack([picks[name] for name in lids]))
        if all(name in picks for name in lids)
        else None
        for lids in LIDS
    ]
    left, right = found
    return None if left is None or right is None else (left, right)


def _skin(vertices: Array, triangles: Ints, part: NDArray[np.intp], picks: Picks) -> Ints:
    """Triangles of the connected part on which most of the picks lie."""
    places = {name: place for name, place in picks.items() if name not in ("3.5", "3.6")}
    on = on_surface(places, vertices, triangles)
    most = np.bincount(part[on.vertices[:, 0]]).argmax()
    return np.asarray(triangles[part[triangles[:, 0]] == most])


def _parts(
    model: Model, part: NDArray[np.intp], skin: Ints, balls: tuple[Ball, Ball] | None
) -> tuple[NDArray[np.intp], list[Part]]:
    """The order (V,) in which parts are runs of vertices, and the parts with triangles that still
    have the model's numbers."""
    count = len(part)
    owner = np.empty(count, dtype=np.intp)
    first = np.cumsum([0, *(len(p.vertices) for p in model.parts)])
    for number in range(len(model.parts)):
        owner[first[number] : first[number + 1]] = number
    kinds = [(_safe(piece.name), "other", "head") for piece in model.parts]
    on_skin = np.zeros(count, dtype=bool)
    on_skin[skin] = True
    for number in np.unique(owner[on_skin]):
        kinds[number] = (kinds[number][0], "skin", "head")
    if balls is not None:
        for side, ball in enumerate(balls):
            owner[ball.vertices] = len(kinds)
            kinds.append((_EYES[side], "eye", _EYES[side]))
    order = np.argsort(owner, kind="stable")
    triangles = model.triangles
    parts, start = [], 0
    names: list[str] = []
    for number, (name, material, follows) in enumerate(kinds):
        size = int((owner == number).sum())
        if not size:
            continue
        names.append(name if name not in names else f"{name} {number}")
        own = triangles[owner[triangles[:, 0]] == number]
        parts.append(Part(names[-1], material, start, start + size, own, follows))
        start += size
    return order, parts


def _safe(name: str) -> str:
    return name[:100] or "part"


def _keys(model: Model, upright: Upright, order: NDArray[np.intp]) -> KeyModels:
    """Key models in an order of their content, so that nothing hangs on names or on the order in
    which a file lists its shapes."""
    turn = (upright.turn.T * upright.scale).astype(np.float32)
    fields = {
        shape.name: np.ascontiguousarray((model.dense(shape) @ turn)[order])
        for shape in model.shapes
        if shape.fields
    }
    names = sorted(fields, key=lambda name: hashlib.sha256(fields[name].tobytes()).digest())
    shape = (0, len(order), 3)
    stacked = np.stack([fields[n] for n in names]) if names else np.zeros(shape, np.float32)
    return KeyModels(tuple(names), stacked)


def _origin(model: Model, upright: Upright, origin: Array) -> Origin | None:
    if model.source is None:
        return None
    return Origin(
        glb=model.source,
        binds={shape.name: shape.binds for shape in model.shapes},
        hooks=model.hooks,
        turn=upright.turn.T,
        scale=upright.scale,
        centre=upright.turn.T @ origin / upright.scale + np.array([upright.middle, 0.0, 0.0]),
        expressions={s.name: s.expression for s in model.shapes if s.expression},
    )
