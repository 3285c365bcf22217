"""The generic face in a performer's shape: the scanned skin, and what no scanner sees beside it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy.spatial import cKDTree

from mien.face.character import Character, KeyModels
from mien.face.face import Array, Face, Ints, Part
from mien.face.mesh import Mesh
from mien.numeric.procrustes import Similarity, align, rigid
from mien.scan.parameterise import Parameterised
from mien.scan.template import Template

_NEIGHBOURS = 120
"""Skin vertices that carry an eyeball, a row of teeth, an ear."""
_HUGGING = ("brow", "lash")
"""Materials of parts that lie on the skin."""
_TOUCHING = 4
_JAW_SHARE = 0.9
"""What jawOpen moves this far, of the most, is bone under skin."""
_COLOUR_REACH = 3.0
"""mm within which a scan's colour is the skin's."""


_CLEARANCE = 0.5
"""mm of lid between an eyeball and the outside."""


def without(character: Character, material: str) -> Character:
    """``character`` without its parts of ``material``: brows, where a scan has its own."""
    face = character.face
    keep = np.ones(len(face.vertices), bool)
    for part in face.parts:
        keep[part.first : part.last] = part.material != material
    number = (np.cumsum(keep) - 1).astype(np.int32)
    parts = tuple(
        replace(
            part,
            first=int(number[part.first]),
            last=int(number[part.last - 1]) + 1,
            triangles=number[part.triangles],
        )
        for part in face.parts
        if part.material != material
    )
    bare = replace(
        face,
        vertices=face.vertices[keep],
        parts=parts,
        colours=face.colours[keep],
        occlusion=face.occlusion[keep],
        points=replace(face.points, vertices=number[face.points.vertices]),
        uv=None if face.uv is None else face.uv[keep],
    )
    keys = KeyModels(character.keys.names, character.keys.displacements[:, keep])
    return replace(character, face=bare, keys=keys)


def skin_vertices(face: Face) -> slice:
    """Those of the part that templates are made of."""
    skin = face.part("skin")
    return slice(skin.first, skin.last)


def performer_face(generic: Face, template: Template, neutral: Parameterised, scan: Mesh) -> Face:
    """``generic`` with the skin of ``neutral``, refined as ``template`` is, in the performer's own
    head frame (origin midway between the eyeballs), and with the colours of ``scan``.

    Eyeballs, teeth, tongue and ears keep their shape and follow the skin about them in place and
    size; brows and lashes lie on the skin.
    """
    own = skin_vertices(generic)
    before = generic.vertices[own]
    after = from_scan(neutral.pose, neutral.vertices[: len(before)])
    tree = cKDTree(before)
    added = len(template.outside) - len(before)
    carried = {
        part.name: _carry(generic.vertices[part.first : part.last], part, tree, before, after)
        for part in generic.parts
        if part.name != "skin"
    }
    pivots = {
        name: np.asarray(_about(tree, before, after, place)(place))
        for name, place in generic.pivots.items()
    }
    for eye in ("eye_left", "eye_right"):
        ball = generic.part(eye)
        places = generic.vertices[ball.first : ball.last]
        pivots[eye] = np.asarray(_about(tree, before, after, places)(generic.pivots[eye]))
    origin = (pivots["eye_left"] + pivots["eye_right"]) / 2.0
    skin = from_scan(neutral.pose, neutral.vertices)

    def refined(values: Array) -> Array:
        return np.asarray(np.clip(template.refinement @ values[own], 0.0, 1.0))

    colours = _skin_colours(neutral, scan, refined(generic.colours))
    rest = slice(own.stop, None)
    return replace(
        generic,
        vertices=np.concatenate([skin, *carried.values()]) - origin,
        parts=tuple(_moved(part, template, added) for part in generic.parts),
        colours=np.concatenate([colours, generic.colours[rest]]),
        occlusion=np.concatenate([refined(generic.occlusion), generic.occlusion[rest]]),
        points=replace(generic.points, vertices=_renumbered(generic.points.vertices, own, added)),
        pivots={name: place - origin for name, place in pivots.items()},
        uv=None,
    )


def expression_motion(
    generic: Character, template: Template, neutral: Parameterised, expression: Parameterised
) -> Array:
    """(V, 3) mm by which a performer's face (``performer_face``) moves from ``neutral`` to
    ``expression``: the skin as scanned, what lies on it with it, lower teeth and tongue with the
    jaw. Eyeballs stay."""
    face = generic.face
    own = skin_vertices(face)
    before = from_scan(neutral.pose, neutral.vertices)
    after = from_scan(expression.pose, expression.vertices)
    count = own.stop - own.start
    drop = np.linalg.norm(generic.keys["jawOpen"], axis=1)
    bone = np.flatnonzero(drop[own] > _JAW_SHARE * drop[own].max())
    jaw = rigid(before[bone], after[bone])
    # Parts rest where the generic face has them relative to the skin: carried as for the neutral.
    tree = cKDTree(face.vertices[own])
    motion = [after - before]
    for part in face.parts:
        if part.name == "skin":
            continue
        places = face.vertices[part.first : part.last]
        if part.material in _HUGGING:
            motion.append(_mean_of(tree, places, (after - before)[:count]))
        elif part.follows == "head" and drop[part.first : part.last].min() > 0.0:
            rest = _carry(places, part, tree, face.vertices[own], before[:count])
            motion.append(jaw(rest) - rest)
        else:
            motion.append(np.zeros_like(places))
    return np.concatenate(motion)


def over_eyes(face: Face, places: Array) -> Array:
    """``places`` (V, 3) of a performer's face with the skin nowhere inside the eyeballs: lids that
    shut in a scan shut over eyeballs that nobody has scanned."""
    clear = places.copy()
    skin = clear[skin_vertices(face)]
    for eye in ("eye_left", "eye_right"):
        ball = face.part(eye)
        centre = face.pivots[eye]
        radius = np.linalg.norm(face.vertices[ball.first : ball.last] - centre, axis=1)
        least = np.median(radius) + _CLEARANCE
        out = skin - centre
        far = np.linalg.norm(out, axis=1, keepdims=True)
        # What lies behind the eyeball is the socket's.
        inside = (far < least) & (out[:, 2:] > 0.0)
        skin[:] = np.where(inside, centre + out * (least / np.maximum(far, 1e-9)), skin)
    return clear


def from_scan(pose: Similarity, places: Array) -> Array:
    """Places of a scan, upright as the head frame is, in millimetres."""
    return np.asarray((places - pose.shift) @ pose.rotation)


def _carry(places: Array, part: Part, tree: cKDTree, before: Array, after: Array) -> Array:
    if part.material in _HUGGING:
        return places + _mean_of(tree, places, after - before)
    return np.asarray(_about(tree, before, after, places)(places))


def _about(tree: cKDTree, before: Array, after: Array, places: Array) -> Callable[[Array], Array]:
    """Shift and size, without a turn, of the skin about ``places``."""
    _, near = tree.query(np.atleast_2d(places), 1)
    centre = np.atleast_2d(places).mean(axis=0)
    _, ring = tree.query(centre, _NEIGHBOURS)
    chosen = np.union1d(near, ring)
    size = align(before[chosen], after[chosen]).scale
    here, there = before[chosen].mean(axis=0), after[chosen].mean(axis=0)
    return lambda points: there + size * (points - here)


def _mean_of(tree: cKDTree, places: Array, values: Array) -> Array:
    _, near = tree.query(places, _TOUCHING)
    return np.asarray(values[near].mean(axis=1))


def _moved(part: Part, template: Template, added: int) -> Part:
    if part.name == "skin":
        return replace(part, last=part.last + added, triangles=template.refined_triangles)
    return replace(
        part,
        first=part.first + added,
        last=part.last + added,
        triangles=(part.triangles + added).astype(np.int32),
    )


def _renumbered(vertices: Ints, own: slice, added: int) -> Ints:
    return np.where(vertices < own.stop, vertices, vertices + added).astype(np.int32)


def _skin_colours(neutral: Parameterised, scan: Mesh, plain: Array) -> Array:
    """(W, 3) the scan's where it was met, the nearest such elsewhere; ``plain`` (W, 3) without."""
    if scan.colours is None or not neutral.reliable.any():
        return plain
    apart, near = cKDTree(scan.vertices).query(neutral.vertices)
    known = np.flatnonzero(neutral.reliable & (apart < _COLOUR_REACH))
    colours = plain.copy()
    colours[known] = scan.colours[near[known]]
    unknown = np.setdiff1d(np.arange(len(plain)), known)
    _, like = cKDTree(neutral.vertices[known]).query(neutral.vertices[unknown])
    colours[unknown] = colours[known[like]]
    return colours
