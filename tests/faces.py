"""A toy face: a few hundred vertices that have every kind of part, point and pivot.

It is lopsided where symmetry could hide a mistake: the two eyes differ in size.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from mien.face.character import Character, KeyModels
from mien.face.face import Face, FeaturePoints, Material, Part
from mien.face.pieces import split
from mien.numeric.rotation import from_vector
from mien.performance.curves import Curves

Array = NDArray[np.float64]
Ints = NDArray[np.int32]

POINTS = {
    "2.1": (0, -70, 45), "2.2": (0, -40, 60), "2.3": (0, -46, 60), "3.13": (32, 14, 45),
    "3.14": (-32, 14, 45), "3.9": (32, -12, 45), "3.10": (-32, -12, 45), "4.1": (12, 24, 50),
    "4.2": (-12, 24, 50), "4.3": (32, 28, 48), "4.4": (-32, 28, 48), "5.3": (38, -20, 45),
    "5.4": (-38, -20, 45), "8.3": (26, -43, 52), "8.4": (-26, -43, 52), "9.3": (0, -15, 70),
}  # fmt: skip
"""FDP id: where it would like to be; it takes the nearest vertices of the skin."""


def toy_character() -> Character:
    """A sphere of a head with two eyes, teeth and a bust, and four key models."""
    pieces = {
        "skin": ("skin", "head", _ball((0, -10, 0), (70, 90, 70), 24, 32)),
        "eye_left": ("eye", "eye_left", _ball((32, 0, 42), (14, 14, 14), 8, 12)),
        "eye_right": ("eye", "eye_right", _ball((-32, 0, 42), (12, 12, 12), 8, 12)),
        "teeth_upper": ("tooth", "head", _ball((0, -40, 40), (20, 4, 8), 5, 8)),
        "bust": ("cloth", "body", _ball((0, -180, -20), (120, 70, 50), 8, 16)),
    }
    vertices, parts, first = [], [], 0
    for name, (material, follows, (places, triangles)) in pieces.items():
        last = first + len(places)
        parts.append(Part(name, material, first, last, triangles + first, follows))
        vertices.append(places)
        first = last
    places = np.concatenate(vertices)
    rng = np.random.default_rng(9)
    face = Face(
        vertices=places,
        parts=tuple(parts),
        materials={
            "skin": Material(0.6, 0.4, 1.0),
            "eye": Material(0.1, 0.9),
            "tooth": Material(0.3, 0.6, casts_shadow=False),
            "cloth": Material(0.9, 0.2),
        },
        colours=rng.uniform(0.2, 0.9, (len(places), 3)),
        occlusion=rng.uniform(0.5, 1.0, len(places)),
        points=_points(places, parts[0]),
        pivots={
            "head": np.array([0.0, -80.0, -30.0]),
            "jaw": np.array([0.0, 4.0, -30.0]),
            "eye_left": np.array([32.0, 0.0, 42.0]),
            "eye_right": np.array([-32.0, 0.0, 42.0]),
        },
    )
    keys = _keys(face)
    return Character("toy_face", face, keys, keys.names)


def _keys(face: Face) -> KeyModels:
    places, skin = face.vertices, face.part("skin")
    on_skin = np.zeros(len(places))
    on_skin[skin.first : skin.last] = 1.0

    def bump(x: float, y: float, radius: float) -> Array:
        square = (places[:, 0] - x) ** 2 + (places[:, 1] - y) ** 2
        near = np.where(square < (2 * radius) ** 2, np.exp(-square / radius**2), 0.0)
        return on_skin * near * (places[:, 2] > 0)

    def field(shape: Array, motion: tuple[float, float, float]) -> NDArray[np.float32]:
        return (shape[:, None] * np.array(motion)).astype(np.float32)

    fields = {
        "smile": field(bump(26, -43, 18), (8, 7, -3)) + field(bump(-26, -43, 18), (-8, 7, -3)),
        "jaw_open": field(bump(0, -75, 25), (0, -20, -4)),
        "blink_left": field(bump(32, 8, 9), (0, -10, 2)),
        "brows_up": field(bump(32, 32, 12), (0, 8, 0)) + field(bump(-32, 32, 12), (0, 8, 0)),
    }
    return KeyModels(tuple(fields), np.stack(list(fields.values())))


def _points(places: Array, skin: Part) -> FeaturePoints:
    wanted = np.array(list(POINTS.values()), dtype=float)
    candidates = places[skin.first : skin.last]
    distance = np.linalg.norm(wanted[:, None] - candidates[None], axis=-1)
    nearest = (np.argsort(distance, axis=1)[:, :3] + skin.first).astype(np.int32)
    return FeaturePoints(tuple(POINTS), nearest, np.full((len(wanted), 3), 1.0 / 3.0))


def _ball(
    centre: tuple[float, float, float], radii: tuple[float, float, float], rings: int, columns: int
) -> tuple[Array, Ints]:
    """An ellipsoid: a pole at the top, ``rings`` rings, a pole at the bottom."""
    polar = np.linspace(0, np.pi, rings + 2)[1:-1, None]
    azimuth = np.linspace(0, 2 * np.pi, columns, endpoint=False)[None]
    x, z = np.sin(polar) * np.sin(azimuth), np.sin(polar) * np.cos(azimuth)
    shell = np.stack([x, np.cos(polar) * np.ones_like(azimuth), z], -1).reshape(-1, 3)
    places = np.concatenate([[[0, 1, 0]], shell, [[0, -1, 0]]]) * radii + centre
    row, col = np.meshgrid(np.arange(rings - 1), np.arange(columns), indexing="ij")
    a, b = 1 + row * columns + col, 1 + row * columns + (col + 1) % columns
    c, d = a + columns, b + columns
    column = np.arange(columns)
    following = (column + 1) % columns
    low, bottom = 1 + (rings - 1) * columns, len(places) - 1
    triangles = [
        np.stack([np.zeros_like(column), 1 + column, 1 + following], -1),
        np.stack([a, c, b], -1).reshape(-1, 3),
        np.stack([b, c, d], -1).reshape(-1, 3),
        np.stack([np.full_like(column, bottom), low + following, low + column], -1),
    ]
    return places, np.concatenate(triangles).astype(np.int32)


def toy_curves(
    character: Character, frames: int = 9, names: tuple[str, ...] | None = None
) -> Curves:
    """A short take at a variable rate in which everything moves."""
    names = names or split(character).names
    rng = np.random.default_rng(4)
    time = np.concatenate([[0.0], np.cumsum(rng.choice([1 / 24, 1 / 30, 1 / 12], frames - 1))])
    return Curves(
        character=character.name,
        names=names,
        time=time,
        weights=rng.uniform(0.0, 1.0, (frames, len(names))),
        rotation=from_vector(rng.uniform(-0.5, 0.5, (frames, 3))),
        translation=rng.uniform(-10.0, 10.0, (frames, 3)),
        gaze=rng.uniform(-0.3, 0.3, (frames, 2, 2)),
        lost=np.zeros(frames, dtype=bool),
        residual=np.zeros(frames),
    )
