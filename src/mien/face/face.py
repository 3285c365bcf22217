"""A face: one mesh in named parts, with feature points and the pivots it turns about."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Ints = NDArray[np.int32]

FOLLOWS = ("head", "eye_left", "eye_right", "body")


@dataclass(frozen=True, slots=True)
class Material:
    """How a part takes light; names follow glTF where glTF has one."""

    roughness: float = 0.6
    specular: float = 0.5
    """0..1, weight of the dielectric highlight."""
    subsurface: float = 0.0
    """0..1, how far light bleeds round the terminator (skin 1)."""
    emission: float = 0.0
    """0..1, fraction of the colour shown whatever the light (catch lights)."""
    casts_shadow: bool = True


@dataclass(frozen=True, slots=True)
class Part:
    """A run of vertices drawn with one material and carried by one thing."""

    name: str
    """Unique in a face: "skin", "eye_left", "teeth_upper", "hair", "bust" ..."""
    material: str
    """Key into ``Face.materials``."""
    first: int
    last: int
    """The part owns vertices ``first`` to ``last - 1``."""
    triangles: Ints
    """(T, 3) indices into the face's vertices, counter-clockwise seen from outside."""
    follows: str = "head"
    """What carries it: "head", "eye_left", "eye_right" (which the head carries), or "body"."""


@dataclass(frozen=True, slots=True)
class FeaturePoints:
    """MPEG-4 feature points fixed to a mesh by three vertices and affine weights each."""

    ids: tuple[str, ...]
    """(P) FDP ids such as "8.3"."""
    vertices: Ints
    """(P, 3) vertex indices."""
    weights: Array
    """(P, 3) weights that sum to 1; barycentric where the point lies on a triangle."""

    def at(self, vertices: NDArray[np.floating[Any]]) -> Array:
        """Places (..., P, 3) of the points on ``vertices`` (..., V, 3); linear, so it maps
        displacement fields as well as positions."""
        corners = vertices[..., self.vertices, :].astype(np.float64)
        return np.asarray(np.einsum("...pcx,pc->...px", corners, self.weights))

    def index(self, ids: Sequence[str]) -> NDArray[np.intp]:
        """Row of each of ``ids``. Raises KeyError for a point that is not here."""
        row = {name: i for i, name in enumerate(self.ids)}
        return np.array([row[name] for name in ids], dtype=np.intp)


@dataclass(frozen=True, slots=True)
class Face:
    """A neutral face in the head frame.

    Axes: origin midway between the eyeball centres, +x to the subject's left, +y up, +z out of
    the face. Millimetres.
    """

    vertices: Array
    """(V, 3) neutral positions."""
    parts: tuple[Part, ...]
    materials: Mapping[str, Material]
    colours: Array
    """(V, 3) linear RGB albedo, 0..1."""
    occlusion: Array
    """(V,) ambient occlusion baked at neutral, 1 = open sky."""
    points: FeaturePoints
    pivots: Mapping[str, Array]
    """(3,) each: "head" (neck), "jaw" (condyles), "eye_left", "eye_right" (eyeball centres)."""
    uv: Array | None = None
    """(V, 2) texture coordinates, u to the right and v down from the picture's upper left corner,
    each material with a picture of its own; None where the face has none."""

    @property
    def triangles(self) -> Ints:
        """(T, 3) triangles of all parts, in their order."""
        return np.concatenate([part.triangles for part in self.parts])

    def part(self, name: str) -> Part:
        """The part called ``name``. Raises KeyError."""
        for part in self.parts:
            if part.name == name:
                return part
        raise KeyError(name)

    def point(self, fdp: str) -> Array:
        """(3,) neutral place of one feature point. Raises KeyError."""
        return np.asarray(self.points.at(self.vertices)[self.points.index([fdp])[0]])
